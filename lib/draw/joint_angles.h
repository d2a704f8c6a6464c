#pragma once

#include <optional>
#include <vector>

#include "math/euler.h"
#include "roles/joint_names.h"
#include "roles/roles.h"
#include "scene/clip.h"

// How far joints are bent, over time, for charts. Degrees; not a number where an angle has no
// meaning, as between bones of length 0.

namespace krok::draw {

// Frames `first` to `last` of a clip, both included; none where first > last.
struct FrameRange {
  int first = 0, last = -1;
};

// Angles of a human body as movement science counts them (Winter, Biomechanics and Motor Control of
// Human Movement, ch. 3; signs as in the ISB's recommendations, Wu et al., J. Biomechanics 35 and
// 38), worked out from where joints are, so that they do not depend on the exporter's bone axes or
// reference pose. All are 0 standing upright with arms hanging.
//
// hip       flexion: from the trunk's axis (middle of the hips to middle of the shoulders) to the
//           thigh, in the sagittal plane, which is square to the line from hip to hip; thigh
//           forward is positive. [-120, 240); none for a thigh within 15 degrees of that line.
// knee      flexion: 180 minus the angle between thigh and shank. Counted in the plane in which the
//           knee bends, so never negative: an overstretched knee shows as slightly bent. [0, 180].
// ankle     dorsiflexion: 90 minus the angle between the shank and the sole, which is level where
//           the figure stands (retarget::find_stance); toes up is positive. [-90, 90].
// shoulder  elevation: between the trunk's axis, downwards, and the upper arm, in whichever plane.
//           [0, 180].
// elbow     flexion: 180 minus the angle between upper arm and forearm. [0, 180].
enum class BodyAngle : unsigned char { hip, knee, ankle, shoulder, elbow };

// One value a frame of the range; empty where the figure lacks a joint that it takes. `side` is
// left or right. The clip must pass check(), the range lie within it.
std::vector<double> body_angle(const Clip& clip, const RoleMap& roles, BodyAngle angle, Side side,
                               const FrameRange& frames);

// How far a joint is turned against its parent away from the reference pose, [0, 180]; the root
// against the world.
std::vector<double> turn_angle(const Clip& clip, int joint, const FrameRange& frames);

// The same turn as Euler angles about the joint's axes as they are in the reference pose, in the
// order of `order`, each frame's the ones closest to those of the frame before: see to_euler and
// closest_euler. Shape [3][frames].
std::vector<std::vector<double>> euler_angles(const Clip& clip, int joint, const EulerOrder& order,
                                              const FrameRange& frames);

}  // namespace krok::draw
