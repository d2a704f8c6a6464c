#pragma once

#include <functional>
#include <span>

#include "scene/model.h"
#include "skin/palette.h"

namespace krok {

// The palette of a moment of a motion; thread-safe. [joints] matrices.
using PaletteSource = std::function<void(int moment, std::span<SkinMatrix> palette)>;

// A model moved by linear blend skinning.
struct MovedModel {
  const Model& model;
  PaletteSource palette;
};

// How far apart two moved meshes come.
struct MeshError {
  double largest = 0;  // metres
  int vertex = 0, moment = 0;
};

// The largest distance of a vertex of one from the same vertex of the other, over the moments 0 to
// `moments` - 1. Both have the same number of vertices. On `jobs` threads (as in parallel_for),
// which does not change the result.
MeshError mesh_error(const MovedModel& a, const MovedModel& b, int moments, int jobs = 1);

}  // namespace krok
