#pragma once

#include <span>
#include <utility>
#include <vector>

#include "roles/roles.h"
#include "scene/frame_source.h"

// Finds motions that are the same under two names.

namespace krok::lint {

// What a motion looks like, whatever its rate, unit, place and heading: the directions of arms and
// legs as the hips see them, at 16 to 33 evenly spaced times.
struct Signature {
  double duration = 0;            // seconds
  std::vector<Vec3f> directions;  // unit; empty for motions that cannot be compared
};

// Empty without the limbs' roles, for fewer than three frames, and for a pose that is held (within
// 3 degrees): many takes have the same one. So it is where frames cannot be read.
Signature signature_of(const FrameSource& motion, const RoleMap& roles);

// Pairs (earlier, later) of the same motion: durations agree within 2 %, and no direction differs
// by more than `radians`. Each motion is paired with the first one that it repeats.
std::vector<std::pair<int, int>> find_duplicates(std::span<const Signature> signatures,
                                                 double radians);

}  // namespace krok::lint
