#pragma once

#include <vector>

#include "plant/legs_internal.h"
#include "plant/smooth_curve_internal.h"
#include "plant/stays_internal.h"

// Where fixed points bring each foot. Used by plant_feet().

namespace krok::plant {

// The bend of a knee, radians, below which a leg is not stretched further than captured: there the
// knee turns far for a little way of the ankle.
inline constexpr double kNearlyStraight = 20 * kRadiansPerDegree;

// What is done to one foot, [frames]; world space.
struct FootPath {
  std::vector<Vec3> turn;   // rotation vectors, to be put on the foot from the left
  std::vector<Vec3> shift;  // metres, of the ankle
};

FootPath foot_path(const Clip& clip, const PlantedBody& body, const Leg& leg,
                   const Footing& footing);

// The same shift before it is drawn through the frames in which nothing stands.
KnownCurve needed_shift(const Clip& clip, const PlantedBody& body, const Leg& leg,
                        const Footing& footing);

// The toes lie on the ground while the heel comes up: of the foot's turn they take the part about
// the vertical.
inline Vec3 turn_of_toes(const Vec3& turn) {
  return {0, turn.y(), 0};
}

}  // namespace krok::plant
