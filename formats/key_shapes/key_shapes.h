#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "skin/key_frame_mesh.h"

// Reader for per-vertex key frames of a mesh (JSON, hand-written); see formats/key_shapes/SPEC.md.

namespace krok::key_shapes {

struct KeyShapeFile {
  std::vector<double> times;        // [keys] seconds, >= 0, strictly increasing
  std::vector<std::string> shapes;  // [keys] paths relative to the file, inside its folder
  ShapeJoin join = ShapeJoin::linear;
  double tension = 0;          // 0 to 1
  std::optional<double> rate;  // frames per second of the result, if in the file
};

// Safe for untrusted input. Codes, each with line and column: json-syntax, json-limit,
// key-shapes-structure, key-shapes-value, key-shapes-path, key-shapes-time (times not increasing).
Result<KeyShapeFile> read(std::string_view text);

// The JSON Schema of such files.
std::string schema();

}  // namespace krok::key_shapes
