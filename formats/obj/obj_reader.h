#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "scene/model.h"

// Wavefront OBJ files of polygons, with their vertices in the file's order, which is what morph
// targets and point caches go by. Source: Wavefront Technologies, Advanced Visualizer Manual,
// appendix B1 (Object Files).

namespace krok::obj {

struct ReadOptions {
  double metres_per_unit = 1;  // > 0; OBJ states none
};

struct Shape {
  // A vertex a `v` line, in order, bound with weight 1 to the one joint "root" in the origin.
  // Groups, objects and materials make parts; polygons are fans from their first corner, whatever
  // their shape, so that the same faces give the same triangles in every shape of a mesh.
  //
  // Where the corners at a vertex have several normals it gets their mean, and of several texture
  // coordinates the first. Normals are there if every corner of a face has one; texture coordinates
  // if any has (0, 0 for the others). u, v have glTF's direction: v down.
  Model model;
  Diagnostics diagnostics;  // warnings: obj-left-out (curves, lines, points), obj-several
};

// `path` is for messages, each with line and column. Trusts nothing in `text`. What the file has
// in other axes than Krok's is not turned. Codes: obj-number (a number that is missing, none, or
// overflows a float), obj-index (a vertex that is not there, or not yet), obj-face (fewer than
// three corners), obj-text (a line that is no OBJ statement), obj-limit (more parts than 65,536 or
// more vertices or triangles than 32 bits count), obj-empty (no vertex).
Result<Shape> read(std::string_view text, const std::string& path, const ReadOptions& options = {});

}  // namespace krok::obj
