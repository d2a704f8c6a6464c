#include "samples/generator/gesture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "math/euler.h"
#include "math/quaternion.h"
#include "samples/generator/curves.h"
#include "samples/generator/walk.h"

namespace krok::samples {

namespace {

constexpr double kLifting = 0.7;  // seconds for an arm to go up, and as long to come down
constexpr double kTurning = 0.5;  // seconds for a head to turn
constexpr double kWavesASecond = 1.4;
constexpr double kStance = 0.62;  // of a stride that a leg stands

Status check_range(const char* what, double value, double least, double most) {
  if (value >= least && value <= most) return {};
  return Error("gesture-option",
               fmt::format("the {} of {:g} is outside {:g} .. {:g}", what, value, least, most));
}

// Up within `time` from the beginning and down again before the end.
double up_and_down(double now, double duration, double time) {
  const double part = std::min(time, 0.5 * duration);
  return ease(now / part) * ease((duration - now) / part);
}

// A pose whose joints are turned one by one, from the root on.
class Posing {
 public:
  Posing(const Actor& actor, std::vector<Transform> joint_to_world)
      : actor_(actor), local_(std::move(joint_to_world)) {
    const Skeleton& skeleton = actor.skeleton;
    for (int j = skeleton.joint_count() - 1; j > 0; --j) {
      local_[at(j)] = local_[at(skeleton.parents[at(j)])].inverse() * local_[at(j)];
    }
  }

  // Turns a joint in its parent's frame on top of what it has.
  void turn(int joint, const Quat& rotation) {
    local_[at(joint)].orientation = rotation * local_[at(joint)].orientation;
  }
  // Brings a joint part of the way to a rotation to its parent.
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

// The frame whose x is `x` and whose y is as near to `y` as it can be.
Quat frame_of(const Vec3& x, const Vec3& y) {
  Mat3 axes;
  axes.col(0) = x.normalized();
  axes.col(2) = axes.col(0).cross(y).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Quat(axes);
}

// The arm goes out to the side and the forearm up, the palm to the front. In the reference pose an
// arm runs along x, away from the body, and its elbow bends about y.
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

// As people spare an aching hip: the trunk over the leg that stands, the head kept level.
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
  WalkOptions standing;
  standing.stature = options.stature;
  standing.steps = 1;
  standing.from_standing = true;
  const auto walk = make_walk(standing);
  if (!walk) return walk.error();
  const Actor& actor = walk->actor;
  std::vector<Transform> stance(actor.skeleton.names.size());
  walk->clip.get_pose(0, stance);

  Clip clip;
  clip.skeleton = actor.skeleton;
  clip.rate = options.rate;
  clip.resize(static_cast<int>(std::floor(options.duration * options.rate + 1e-6)) + 1);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    // The last frame is the end, whether or not the duration is a whole number of frames.
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
