#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "scene/model.h"

// Reads Wavefront OBJ files of polygons. Keeps the file's vertex order, which morph targets and
// point caches rely on. Source: Wavefront Technologies, Advanced Visualizer Manual, appendix B1
// (Object Files).

namespace krok::obj {

struct ReadOptions {
  double metres_per_unit = 1;  // > 0; OBJ files do not specify it
};

struct Shape {
  // One vertex per `v` line, in order, bound with weight 1 to the only joint, "root", at the
  // origin. Groups, objects and materials become parts. Polygons are triangulated as fans from
  // their first corner, whatever their shape, so that all shapes of a mesh get the same triangles.
  //
  // A vertex gets the mean of its corners' normals and the first of their texture coordinates.
  // Normals are present if every corner has one; texture coordinates if any corner has one (0, 0
  // for the others). v is down, as in glTF.
  Model model;
  Diagnostics diagnostics;  // warnings: obj-left-out (curves, lines, points), obj-several
};

// `path` is for messages, which have line and column. `text` is not trusted. Axes are not
// converted. Codes: obj-number (missing, invalid, or overflows a float), obj-index (a vertex that
// does not exist, or not yet), obj-face (fewer than three corners), obj-text (not an OBJ
// statement), obj-limit (more than 65,536 parts, or vertices or triangles beyond 32 bits),
// obj-empty (no vertex).
Result<Shape> read(std::string_view text, const std::string& path, const ReadOptions& options = {});

}  // namespace krok::obj
