#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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
  all  // one joint for the four fingers together, as in CMU's skeletons
};

// Where a joint is on its finger. The joint of a phalanx is the one whose rotation moves it: 1 is
// at the knuckle, 2 and 3 beyond it. The thumb has its first joint at the wrist and is counted from
// there, so that it has 1 to 3 too.
struct FingerJoint {
  static constexpr int kMetacarpal = 0;  // a joint in the palm that leads to the knuckle
  static constexpr int kTip = 4;         // beyond the last phalanx

  Finger finger = Finger::none;
  int phalanx = 0;

  bool operator==(const FingerJoint&) const = default;
};

// "index_1", "thumb_3", "ring_metacarpal", "little_tip", "all_1"; empty for Finger::none.
std::string finger_place_name(FingerJoint place);

// The inverse of finger_place_name; nothing for other texts.
std::optional<FingerJoint> parse_finger_joint(std::string_view name);

// Which finger each joint beyond one wrist belongs to, from the joints' names ("LeftHandIndex2",
// "lMid1", "LFinger21", "LeftSecondPP", "finger3-1.L") and from their order along the finger, which
// counts the phalanges whatever numbers the names have. `beyond_wrist` lists those joints, parents
// first. Same length and order as `beyond_wrist`; Finger::none for joints in the palm that several
// fingers hang on and for names that tell no finger.
std::vector<FingerJoint> find_fingers(const Skeleton& skeleton, std::span<const int> beyond_wrist);

}  // namespace krok
