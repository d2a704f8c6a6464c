#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/skeleton.h"

namespace krok {

enum class Finger : unsigned char {
  none,
  thumb,
  index,
  middle,
  ring,
  little,
  all  // one joint for all four fingers together, as in CMU skeletons
};

// Finger and phalanx of a joint. The joint of a phalanx is the one whose rotation moves it: 1 is at
// the knuckle, 2 and 3 beyond it. The thumb is counted from its joint at the wrist, so it has 1 to
// 3 too.
struct FingerJoint {
  static constexpr int kMetacarpal = 0;  // a joint in the palm that leads to the knuckle
  static constexpr int kTip = 4;         // beyond the last phalanx

  Finger finger = Finger::none;
  int phalanx = 0;

  bool operator==(const FingerJoint&) const = default;
};

// "index_1", "thumb_3", "ring_metacarpal", "little_tip", "all_1"; empty for Finger::none.
std::string finger_place_name(FingerJoint place);

// The inverse of finger_place_name; empty for other text.
std::optional<FingerJoint> parse_finger_joint(std::string_view name);

// Finger and phalanx of each joint beyond one wrist. The finger comes from the joint names
// ("LeftHandIndex2", "lMid1", "LFinger21", "LeftSecondPP", "finger3-1.L"), the phalanx from the
// order along the finger, regardless of numbers in the names. `beyond_wrist` lists the joints,
// parents first. Returns the same length and order; Finger::none for palm joints shared by several
// fingers and for names without a finger.
std::vector<FingerJoint> find_fingers(const Skeleton& skeleton, std::span<const int> beyond_wrist);

}  // namespace krok
