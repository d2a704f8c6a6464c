#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "math/types.h"
#include "retarget/foot_points.h"
#include "retarget/pose_alignment.h"
#include "scene/clip.h"

// What an actor touches, found in its motion: the ground with hands, elbows, knees, feet that do
// not stand on it and the seat, the other hand, and its own body.

namespace krok::retarget {

// Frames from `first` to `last`, both included.
struct Stay {
  int first = 0, last = 0;
};

// A distance over time that counts as a touch while it is small.
struct Touch {
  std::vector<Stay> stays;     // in order, apart
  std::vector<double> weight;  // [frames], 1 in a stay, fading to 0 with distance from it and time
};

struct TouchLimits {
  double near = 0;      // metres, at or below it touches
  double far = 0;       // metres, the weight is 0 from here on
  double speed = 0;     // metres per second, at or below
  double shortest = 0;  // seconds
};

// `distance` and `speed` are [frames]. The weight is 0 all along if nothing ever touches.
Touch find_touch(std::span<const double> distance, std::span<const double> speed,
                 const TouchLimits& limits, double rate);

enum class BodyPart : unsigned char {
  left_hand,
  right_hand,
  left_elbow,
  right_elbow,
  left_knee,
  right_knee,
  left_foot,
  right_foot,
  hips
};
inline constexpr int kBodyParts = 9;

// "left hand", "hips".
const char* name_of(BodyPart part);

inline BodyPoint at_joint(int joint) {
  return {joint, Vec3::Zero()};
}

// The same points of two actors: the middle of the palm (the wrist if one of them has no more of a
// hand), the joints of elbow and knee, the ball of the foot (the ankle likewise), the hips. Joint
// -1 where either lacks it.
struct PointPair {
  BodyPoint source, target;
};
std::array<PointPair, kBodyParts> body_points(const Actor& source, const Actor& target);

// A part of a body that hands touch: what lies around the line between two joints.
struct BodyBone {
  const char* name = "";
  int from = -1, to = -1;            // of the source
  int onto_from = -1, onto_to = -1;  // of the target
  double radius = 0;                 // in leg lengths, within which a palm touches
  std::optional<bool> is_left;       // arms: whose
  // Fraction of the bone above which a palm is beside the pelvis, as those of runners with bent
  // arms, which other proportions would pull down to the thigh.
  double begins = -1e9;
};
std::vector<BodyBone> body_bones(const Actor& source, const Actor& target);

// Where a point is by a line: the nearest place on it as a fraction, and the way from there.
struct BesideLine {
  double along = 0;  // 0 to 1
  Vec3 off = Vec3::Zero();
};
BesideLine beside_line(const Vec3& point, const Vec3& from, const Vec3& to);

}  // namespace krok::retarget
