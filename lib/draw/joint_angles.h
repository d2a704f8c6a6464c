#pragma once

#include <vector>

#include "math/quaternion.h"
#include "roles/joint_names.h"
#include "roles/roles.h"
#include "scene/clip.h"

// Joint angles over time, for charts. Degrees; NaN where an angle is undefined, as between bones of
// zero length.

namespace krok::draw {

// Frames `first` to `last` of a clip, inclusive; empty if first > last.
struct FrameRange {
  int first = 0, last = -1;
};

// Anatomical joint angles (Winter, Biomechanics and Motor Control of Human Movement, ch. 3; signs
// follow the ISB recommendations, Wu et al., J. Biomechanics 35 and 38), computed from joint
// positions, so that they do not depend on the exporter's bone axes or reference pose. All are 0
// when standing upright with the arms hanging.
//
// hip       flexion: from the trunk axis (mid-hip to mid-shoulder) to the thigh, in the sagittal
//           plane, which is perpendicular to the line between the hips; thigh forward is positive.
//           [-120, 240); NaN for a thigh within 15 degrees of that line.
// knee      flexion: 180 minus the angle between thigh and shank. Measured in the plane in which
//           the knee bends, so never negative: hyperextension appears as slight flexion. [0, 180].
// ankle     dorsiflexion: 90 minus the angle between the shank and the sole, which is level in the
//           standing pose (retarget::find_stance); toes up is positive. [-90, 90].
// shoulder  elevation: between the downward trunk axis and the upper arm, in any plane. [0, 180].
// elbow     flexion: 180 minus the angle between upper arm and forearm. [0, 180].
enum class BodyAngle : unsigned char { hip, knee, ankle, shoulder, elbow };

// One value per frame of the range; empty if the skeleton lacks a required joint. `side` is left or
// right. The clip must pass check() and contain the range. `soles`: those of the motion that the
// clip is a part of; null: the clip's.
struct Soles;
std::vector<double> body_angle(const Clip& clip, const RoleMap& roles, BodyAngle angle, Side side,
                               const FrameRange& frames, const Soles* soles = nullptr);

// Directions of the soles in the frames of the ankles, zero if unknown. Found from the frames that
// retarget::frames_looked_at() gives as from the whole motion.
struct Soles {
  Vec3 left = Vec3::Zero(), right = Vec3::Zero();
};
Soles find_soles(const Clip& clip, const RoleMap& roles);

// Angle of a joint's local rotation from the reference pose, [0, 180]; for the root, in world
// space.
std::vector<double> turn_angle(const Clip& clip, int joint, const FrameRange& frames);

// The same rotation as Euler angles about the joint's axes in the reference pose, in the given
// order. Continuous: each frame takes the solution closest to the frame before (to_euler,
// closest_euler). Shape [3][frames].
std::vector<std::vector<double>> euler_angles(const Clip& clip, int joint, const EulerOrder& order,
                                              const FrameRange& frames);

}  // namespace krok::draw
