#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "draw/pack_motion_internal.h"
#include "scene/clip.h"

// Private to this folder: how the page draws a skeleton.

namespace krok::draw {

struct DrawnBones {
  // A bone beyond a joint that ends without an end site, such as a head or toes.
  struct Stub {
    int joint = 0;
    Vec3 tip = Vec3::Zero();  // metres, in the joint's space
  };

  // The joint that the camera follows: the hips, or the root.
  int hips = 0;
  // Joints whose line to the parent is no bone of the body: the hips below a root that only
  // positions the character, and what else hangs on such a root without being a limb.
  std::vector<int> loose;
  std::vector<Stub> stubs;
  std::vector<int> left, right;  // the joints of each foot, from the ankle on
};

// `moves`: [joints], 1 if a joint's place relative to its parent changes. Directions of stubs are
// those of the bone before them in the standing pose (retarget::neutral_skeleton); toes and feet
// point along the sole. Lengths are shares of the body's extent. Helpers have none.
DrawnBones find_drawn_bones(const Clip& clip, std::span<const std::uint8_t> moves);

void pack_drawn_bones(const DrawnBones& bones, Json& item);

}  // namespace krok::draw
