#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "lint/rules.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

// Finds faults of motions: what a capture or an export broke, by rule, with its place.

namespace krok::lint {

struct Finding {
  Rule rule = Rule::unreadable;
  std::string kind;         // of rules that tell several apart: "spike", "step", "seam"
  std::string mesh;         // of the rules of meshes: its name; frames do not matter
  int joint = -1;           // the worst joint, -1: the whole body
  int joints = 1;           // how many show the fault at the same time
  int first = 0, last = 0;  // frames, inclusive
  int worst = 0;            // the frame at which the fault shows best
  double value = 0;         // in `unit`
  double threshold = 0;     // in `unit`
  std::string unit;         // "m", "deg", "s", "%", "fps" or ""
  std::string detail;       // what the value alone does not say; may be empty

  // How many times the threshold the value is, for sorting; a value far below a lower bound counts
  // by its inverse.
  double excess() const;
};

struct MotionOptions {
  Settings settings;
  bool is_loop = false;    // the first pose follows the last
  bool treadmill = false;  // feet are carried by the ground: foot-slide and drift do not apply
  // Height of the ground below a point (metres, world), empty where there is none. Without it the
  // ground is taken to be level where the feet stand.
  std::function<std::optional<double>(const Vec3& point)> ground;
};

struct MotionFaults {
  std::vector<Finding> findings;  // by rule, then frame
  // Rules that could not judge the motion, with the reason: "ground: the feet stand at heights
  // that differ by 0.61 m".
  std::vector<std::string> notes;
};

// The length of the legs as a multiple of 0.86 m, by which limits of lengths scale; 1 if not known.
double legs_scale(const Skeleton& skeleton, const RoleMap& roles);

// All rules of one motion. `roles`: of the clip's joints; rules about feet, limits and sides need
// them and are left out otherwise. The clip must pass check().
//
// - pop, flip, jitter, over-smooth: rotations of each joint in its parent, and the path of the
//   hips. A pop is a pattern of accelerations that only a jump makes (1 -2 1 for a spike of one
//   frame, 1 -1 for a step), larger than what is left around it when it is taken out, than the
//   usual of the second around it and, if not far larger, than what is like it elsewhere, as
//   gestures and impacts come again. Noise is the deviation left by the
//   fourth difference (weights 1 -4 6 -4 1), where successive accelerations have opposite signs as
//   noise makes them.
// - foot-slide: how far the slowest point of the soles near the ground moves without a rest, and
//   how far a foot moves in one contact (find_contacts()).
// - frame-rate: repeated frames, how fast the hips fall in runs, and the duration of swings, about
//   that of a pendulum whatever the speed (Mochon and McMahon, "Ballistic walking", J. Biomech. 13,
//   1980).
// - joint-limit: knees that bend forwards. Ranges of other joints depend on how a skeleton shares
//   them and on its reference pose.
MotionFaults lint_motion(const Clip& clip, const RoleMap& roles, const MotionOptions& options);

// Faults of takes that do not fit in memory.

// What `judge`, such as lint_motion(), finds in parts of a take of about 32 MB each. A fault
// belongs to the part that its worst frame is in, one that goes on into the next part is one. What
// is usual in the motion is judged within a part and the 10 seconds around it: a take of one part
// has the faults that `judge` finds in it, a longer one those of its minutes rather than of the
// whole. The ends of a loop are compared by themselves.
//
// `judge` is called in the order of the parts. Codes: those of the source.
Result<MotionFaults> lint_long_take(
    const FrameSource& motion, const MotionOptions& options, int jobs,
    const std::function<MotionFaults(const Clip& part, const MotionOptions& how)>& judge,
    std::size_t part_bytes = std::size_t{32} << 20);

// Finds motions that are the same under two names.

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
