#include "samples/generator/gesture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "math/quaternion.h"
#include "samples/generator/curves.h"
#include "samples/generator/walk.h"

namespace krok::samples {

namespace {

constexpr double kLifting = 0.7;  // seconds to raise an arm, and to lower it
constexpr double kTurning = 0.5;  // seconds to turn the head
constexpr double kWavesASecond = 1.4;
constexpr double kStance = 0.62;  // stance fraction of a stride

Status check_range(const char* what, double value, double least, double most) {
  if (value >= least && value <= most) return {};
  return Error("gesture-option",
               fmt::format("the {} of {:g} is outside {:g} .. {:g}", what, value, least, most));
}

// Rises within `time` from the start and falls within `time` before the end.
double up_and_down(double now, double duration, double time) {
  const double part = std::min(time, 0.5 * duration);
  return ease(now / part) * ease((duration - now) / part);
}

// A pose built by rotating joints one by one, starting at the root.
class Posing {
 public:
  Posing(const Actor& actor, std::vector<Transform> joint_to_world)
      : actor_(actor), local_(std::move(joint_to_world)) {
    const Skeleton& skeleton = actor.skeleton;
    for (int j = skeleton.joint_count() - 1; j > 0; --j) {
      local_[at(j)] = local_[at(skeleton.parents[at(j)])].inverse() * local_[at(j)];
    }
  }

  // Adds a rotation of a joint, in its parent's frame.
  void turn(int joint, const Quat& rotation) {
    local_[at(joint)].orientation = rotation * local_[at(joint)].orientation;
  }
  // Blends a joint's local rotation towards `joint_to_parent`.
  void bring(int joint, const Quat& joint_to_parent, double part) {
    local_[at(joint)].orientation = slerp(local_[at(joint)].orientation, joint_to_parent, part);
  }

  std::vector<Transform> world() const {
    std::vector<Transform> world = local_;
    for (int j = 1; j < actor_.skeleton.joint_count(); ++j) {
      world[at(j)] = world[at(actor_.skeleton.parents[at(j)])] * local_[at(j)];
    }
    return world;
  }

 private:
  const Actor& actor_;
  std::vector<Transform> local_;
};

// The frame with x axis `x` and y axis as close to `y` as possible.
Quat frame_of(const Vec3& x, const Vec3& y) {
  Mat3 axes;
  axes.col(0) = x.normalized();
  axes.col(2) = axes.col(0).cross(y).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Quat(axes);
}

// Upper arm to the side, forearm up, palm forward. In the reference pose an arm is along x, away
// from the body, and the elbow flexes about y.
void wave(const Actor& actor, const GestureOptions& options, double time, Posing& pose) {
  const double sign = side_sign(options.side);
  const ArmJoints& arm = actor.arms[at(static_cast<int>(options.side))];
  const double up = up_and_down(time, options.duration, kLifting);
  const double swing = 24 * kRadiansPerDegree *
                       std::sin(2 * kPi * kWavesASecond * (time - kLifting)) *
                       up_and_down(time, options.duration, 1.4 * kLifting);
  const Vec3 upper = Vec3(sign * 0.85, -0.22, 0.42).normalized();
  const Vec3 lower = axis_rotation(Axis::z, -sign * swing) * Vec3(sign * 0.12, 1, 0.2).normalized();
  const Vec3 hinge = -sign * upper.cross(lower).normalized();
  const Quat upper_to_chest = frame_of(sign * upper, hinge);
  const Quat lower_to_chest = frame_of(sign * lower, hinge);
  pose.turn(arm.collar,
            slerp(Quat::Identity(), axis_rotation(Axis::z, sign * 9 * kRadiansPerDegree), up));
  pose.bring(arm.upper, upper_to_chest, up);
  pose.bring(arm.lower, upper_to_chest.conjugate() * lower_to_chest, up);
  pose.bring(arm.hand, axis_rotation(Axis::z, -sign * 0.5 * swing), up);
  pose.turn(actor.head, axis_rotation(Axis::y, sign * 12 * kRadiansPerDegree * up));
}

// Gait with a painful hip: the trunk leans over the stance leg, the head stays level.
void limp(const Actor& actor, const GestureOptions& options, double time, Posing& pose) {
  const double sign = side_sign(options.side);
  const double phase = std::clamp(time / options.duration / kStance, 0.0, 1.0);
  const double lean = 0.5 - 0.5 * std::cos(2 * kPi * phase);
  const Quat third = axis_rotation(Axis::z, -sign * 5 * kRadiansPerDegree * lean) *
                     axis_rotation(Axis::x, 2.5 * kRadiansPerDegree * lean);
  for (const int joint : {actor.spine, actor.spine1, actor.spine2}) pose.turn(joint, third);
  for (const int joint : {actor.neck, actor.head}) pose.turn(joint, third.conjugate());
  const ArmJoints& arm = actor.arms[at(static_cast<int>(options.side))];
  pose.turn(arm.upper, axis_rotation(Axis::z, sign * 10 * kRadiansPerDegree * lean));
}

void look(const Actor& actor, const GestureOptions& options, double time, Posing& pose) {
  const double turned = side_sign(options.side) * up_and_down(time, options.duration, kTurning);
  pose.turn(actor.spine2, axis_rotation(Axis::y, 8 * kRadiansPerDegree * turned));
  pose.turn(actor.neck, axis_rotation(Axis::y, 22 * kRadiansPerDegree * turned));
  pose.turn(actor.head, axis_rotation(Axis::y, 30 * kRadiansPerDegree * turned));
}

Status check(const GestureOptions& options) {
  if (Status status = check_range("stature", options.stature, 0.5, 2.5); !status) return status;
  if (Status status = check_range("duration", options.duration, 0.2, 600); !status) return status;
  return check_range("rate", options.rate, 1, 1000);
}

}  // namespace

Result<Clip> make_gesture(const GestureOptions& options) {
  if (Status status = check(options); !status) return status.error();
  const auto standing = make_standing_actor(options.stature);
  if (!standing) return standing.error();
  const auto& [actor, stance] = *standing;

  Clip clip;
  clip.skeleton = actor.skeleton;
  clip.rate = options.rate;
  clip.resize(static_cast<int>(std::floor(options.duration * options.rate + 1e-6)) + 1);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    // The last frame is the end even if the duration is not a whole number of frames.
    const double time = options.duration * frame / std::max(1, clip.frame_count() - 1);
    Posing pose(actor, stance);
    switch (options.gesture) {
      case Gesture::wave:
        wave(actor, options, time, pose);
        break;
      case Gesture::limp:
        limp(actor, options, time, pose);
        break;
      case Gesture::look:
        look(actor, options, time, pose);
        break;
    }
    clip.set_pose(frame, pose.world());
  }
  return clip;
}

}  // namespace krok::samples
