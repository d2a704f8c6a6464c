#pragma once

#include <span>
#include <string>

#include "scene/morph_set.h"
#include "tools/common/report.h"

namespace krok::morph {

// How far a target moves a mesh; metres.
struct Movement {
  int moved = 0;       // vertices, by more than a thousandth of a millimetre
  double largest = 0;  // of all vertices
  int vertex = -1;     // the one that moves farthest; -1 where none moves
  double mean = 0;     // over those that move
};

Movement movement_of(std::span<const Vec3f> base, std::span<const Vec3f> target);

// For reports: "vertices_moved", "largest_mm", "vertex", "mean_mm".
Json to_json(const Movement& movement);

// "moves 312 vertices, at most 12.3 mm (vertex 88), 3.1 mm in the mean".
std::string describe(const Movement& movement);

}  // namespace krok::morph
