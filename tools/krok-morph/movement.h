#pragma once

#include <span>
#include <string>

#include "scene/morph_set.h"
#include "tools/cli/report.h"

namespace krok::cli::morph {

// How far a target displaces a mesh, in metres.
struct Movement {
  int moved = 0;       // vertices displaced by more than 1e-6 m
  double largest = 0;  // of all vertices
  int vertex = -1;     // with the largest displacement; -1 if none moves
  double mean = 0;     // over moved vertices
};

Movement movement_of(std::span<const Vec3f> base, std::span<const Vec3f> target);

// For reports: "vertices_moved", "largest_distance", "vertex", "mean_distance".
Json to_json(const Movement& movement);

// "moves 312 vertices, max 12.3 mm (vertex 88), mean 3.1 mm".
std::string describe(const Movement& movement);

}  // namespace krok::cli::morph
