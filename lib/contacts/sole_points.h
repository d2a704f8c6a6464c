#pragma once

#include <array>
#include <vector>

#include "roles/roles.h"
#include "scene/clip.h"

// The points of a foot that touch the ground, on whatever joints a skeleton has for it.

namespace krok {

enum class FootSide : unsigned char { left, right };
enum class FootPart : unsigned char { heel, ball, tip };

// "left", "right"; "heel", "ball", "tip".
const char* name_of(FootSide side);
const char* name_of(FootPart part);

// A point that is fixed to a joint.
struct SolePoint {
  FootSide side = FootSide::left;
  FootPart part = FootPart::heel;
  int joint = 0;
  Vec3 offset = Vec3::Zero();  // metres, in the joint's frame
  // Whether no joint marks the place, so that it was put there after a foot's usual measures.
  bool estimated = false;
};

struct Feet {
  double leg_length = 0;  // metres, hip to ankle over the knee, the mean of both; 0: no legs
  std::array<std::vector<SolePoint>, 2> points;  // [FootSide], heel before ball before tip
};

// The sole points of a figure. The heel is put behind and below the ankle, a tip that no end site
// marks before the ball, after Drillis and Contini's foot (Winter, "Biomechanics and Motor Control
// of Human Movement"): ankle 0.039 of the stature above the sole and 0.036 before the heel, which
// is 0.079 and 0.073 of the leg. Which way is down in the foot's frame is read off the frames in
// which the foot stands still, for reference poses may point the toes anywhere; where there are
// none, off the frames in which it is lowest, and for a clip of fewer than five frames off the
// reference pose. A foot that is an end site alone has one point, at the ankle.
Feet find_feet(const Clip& clip, const RoleMap& roles);

// Where a point is in each frame, shape [frames]. A first frame from which the point jumps away (a
// rest pose before the capture: over a tenth of a leg more than three times what it does in the
// next two frames) is put where the movement after it leads back to.
std::vector<Vec3> track_of(const Clip& clip, const SolePoint& point, double leg_length);

}  // namespace krok
