#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/key_shapes/key_shapes.h"
#include "scene/morph_set.h"
#include "tools/krok-morph/shape_file.h"

namespace krok::morph {

// Shapes at times, with all files read.
struct KeyShapes {
  ShapeFile base;             // the shape of the first key
  MorphSet shapes;            // each file's once, the first key's too
  std::vector<double> times;  // [keys] seconds, rising
  std::vector<int> shape_of;  // [keys] which of the shapes
  ShapeJoin join = ShapeJoin::linear;
  double tension = 0;
  double rate = 30;
};

// What the action frames is given: a file of keys, or a folder with a shape a file, taken in the
// order of their names ("2" before "10"). Options go before what the file says.
Result<KeyShapes> read_key_shapes(const Options& options, ToolContext& context);

}  // namespace krok::morph
