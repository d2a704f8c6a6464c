#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "skin/key_frame_mesh.h"

// Which shapes a mesh has when, as a text file that people write: per-vertex key frames.
// formats/key_shapes/SPEC.md describes it.

namespace krok::key_shapes {

struct KeyShapeFile {
  std::vector<double> times;        // [keys] seconds from 0, rising strictly
  std::vector<std::string> shapes;  // [keys] paths relative to the file, within its folder
  ShapeJoin join = ShapeJoin::linear;
  double tension = 0;          // 0 to 1
  std::optional<double> rate;  // frames a second of the result, where the file tells
};

// Trusts nothing in `text`. Codes, each with line and column: json-syntax, json-limit,
// key-shapes-structure, key-shapes-value, key-shapes-path, key-shapes-time (times that do not
// rise).
Result<KeyShapeFile> read(std::string_view text);

}  // namespace krok::key_shapes
