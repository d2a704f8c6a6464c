#pragma once

#include <vector>

#include "plant/legs_internal.h"
#include "plant/stays_internal.h"

// Where fixed points bring each foot. Used by plant_feet().

namespace krok::plant {

// What is done to one foot, [frames]; world space.
struct FootPath {
  std::vector<Vec3> turn;   // rotation vectors, to be put on the foot from the left
  std::vector<Vec3> shift;  // metres, of the ankle
};

struct Paths {
  std::vector<FootPath> feet;  // [legs]
  std::vector<Vec3> body;      // metres, [frames]: of everything from the pelvis on, feet included
};

Paths foot_paths(const Clip& clip, const PlantedBody& body, const std::vector<Footing>& footings);

// The toes lie on the ground while the heel comes up: of the foot's turn they take the part about
// the vertical.
inline Vec3 turn_of_toes(const Vec3& turn) {
  return {0, turn.y(), 0};
}

}  // namespace krok::plant
