#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/key_shapes/key_shapes.h"
#include "scene/morph_set.h"
#include "tools/krok-morph/shape_file.h"

namespace krok::cli::morph {

// Key shapes with times; all files have been read.
struct KeyShapes {
  ShapeFile base;             // shape of the first key
  MorphSet shapes;            // one per file, including the first key's
  std::vector<double> times;  // [keys] seconds, ascending
  std::vector<int> shape_of;  // [keys] index into shapes
  ShapeJoin join = ShapeJoin::linear;
  double tension = 0;
  double rate = 30;
};

// Input of the action frames: a key file, or a folder with one shape per file, in natural name
// order ("2" before "10"). Options override the file.
Result<KeyShapes> read_key_shapes(const Options& options, ToolContext& context);

}  // namespace krok::cli::morph
