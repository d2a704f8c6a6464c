#pragma once

#include <functional>
#include <span>

#include "scene/model.h"
#include "skin/palette.h"

namespace krok {

// The palette of a moment of a motion; thread-safe. [joints] matrices.
using PaletteSource = std::function<void(int moment, std::span<SkinMatrix> palette)>;

// The vertices of a moment before joints move them; thread-safe. [vertices] positions.
using ShapeAtMoment = std::function<void(int moment, std::span<Vec3f> positions)>;

// A model moved by linear blend skinning.
struct MovedModel {
  const Model& model;
  PaletteSource palette;
  ShapeAtMoment shape = {};  // none: the model's own vertices at all moments
};

// Makes, for one thread, what fills the vertices of a mesh as it is shown at a moment. NaN: not
// shown, not compared.
using ShownMesh = std::function<ShapeAtMoment()>;

// As linear blend skinning shows it; refers to the model.
ShownMesh shown(const MovedModel& moved);

// How far apart two moved meshes come.
struct MeshError {
  double largest = 0;  // metres
  int vertex = 0, moment = 0;
};

// The largest distance of a vertex of one from the same vertex of the other, over the moments 0 to
// `moments` - 1. Both have the same number of vertices. On `jobs` threads (as in parallel_for),
// which does not change the result.
MeshError mesh_error(const ShownMesh& a, const ShownMesh& b, int vertices, int moments,
                     int jobs = 1);
MeshError mesh_error(const MovedModel& a, const MovedModel& b, int moments, int jobs = 1);

}  // namespace krok
