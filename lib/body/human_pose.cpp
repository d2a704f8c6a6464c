#include "body/human_pose.h"

#include <algorithm>
#include <cmath>

#include "math/quaternion.h"

namespace krok::body {

namespace {

constexpr double kDegree = kRadiansPerDegree;

double angle(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

class Straightener {
 public:
  Straightener(const Skeleton& skeleton, const HumanFigure& figure, std::span<const Transform> pose)
      : skeleton_(skeleton), figure_(figure), pose_(pose.begin(), pose.end()) {}

  StandingPose run() {
    face_forward();
    straighten_trunk();
    for (std::size_t side = 0; side < 2; ++side) {
      place_leg(side);
      place_arm(side);
    }
    return {std::move(pose_), turned_, heading_};
  }

 private:
  Vec3 position(int joint) const { return pose_[static_cast<std::size_t>(joint)].position; }
  Vec3 bone(int from, int to) const { return position(to) - position(from); }

  void rotate(int joint, const Quat& rotation) {
    const Vec3 pivot = position(joint);
    std::vector<char> below(pose_.size(), 0);
    below[static_cast<std::size_t>(joint)] = 1;
    for (std::size_t j = static_cast<std::size_t>(joint); j < pose_.size(); ++j) {
      const int parent = skeleton_.parents[j];
      if (parent >= joint && below[static_cast<std::size_t>(parent)]) below[j] = 1;
      if (!below[j]) continue;
      pose_[j].position = pivot + rotation * (pose_[j].position - pivot);
      pose_[j].orientation = normalized_or_identity(rotation * pose_[j].orientation);
    }
  }

  // Turns `joint` so that the bone to `child` points along `wanted`, if it is more than `tolerance`
  // away from it.
  void point(int joint, int child, const Vec3& wanted, double tolerance) {
    const Vec3 now = bone(joint, child);
    if (now.norm() < 1e-3 * figure_.stature) return;
    const double off = angle(now, wanted);
    if (off <= tolerance) return;
    rotate(joint, shortest_arc(now, wanted));
    turned_ += off;
  }

  void face_forward() {
    const HumanAxes axes = human_axes(figure_, pose_);
    Mat3 from;
    from << axes.left, axes.up, axes.forward;
    const double tilt = angle(axes.up, Vec3::UnitY());
    const double turn = angle(axes.forward, Vec3::UnitZ());
    if (tilt < 10 * kDegree && turn < 10 * kDegree) return;
    const Quat rotation = normalized_or_identity(Quat(Mat3(from.transpose())));
    heading_ = std::max(tilt, turn);
    rotate(0, rotation);
  }

  void straighten_trunk() {
    const auto path = joint_path(skeleton_, figure_.hips, figure_.head >= 0 ? figure_.head
                                                                            : figure_.neck);
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (path.size() < 2) break;
      point(path[i - 1], path[i], Vec3::UnitY(), 40 * kDegree);
    }
    if (figure_.head >= 0 && figure_.head_top >= 0) {
      point(figure_.head, figure_.head_top, Vec3::UnitY(), 35 * kDegree);
    }
  }

  void place_leg(std::size_t side) {
    const auto& leg = figure_.legs[side];
    const double out = side == 0 ? 1.0 : -1.0;
    const Vec3 down = Vec3(0.06 * out, -1, 0).normalized();
    const Vec3 thigh = bone(leg.hip, leg.knee).normalized();
    const double apart = out * thigh.x();
    const bool crossing = apart < -0.06 || apart > 0.30 || std::abs(thigh.z()) > 0.30;
    point(leg.hip, leg.knee, down, crossing ? 0 : 25 * kDegree);
    const Vec3 upper = bone(leg.hip, leg.knee).normalized();
    point(leg.knee, leg.ankle, Vec3(upper.x(), upper.y(), std::min(0.0, upper.z())), 20 * kDegree);
    const int far = leg.toes >= 0 ? leg.toes : leg.tip;
    if (far < 0) return;
    const Vec3 foot = bone(leg.ankle, far);
    const double level = std::hypot(foot.x(), foot.z());
    const double pitch = std::atan2(-foot.y(), level);
    const double yaw = std::atan2(out * foot.x(), foot.z());
    const bool fits = pitch > -12 * kDegree && pitch < 60 * kDegree && yaw > -20 * kDegree &&
                      yaw < 40 * kDegree;
    if (!fits) {
      const Vec3 wanted(0.1 * out, -std::tan(leg.toes >= 0 ? 25 * kDegree : 10 * kDegree), 1);
      point(leg.ankle, far, wanted, 0);
    }
    if (leg.toes >= 0 && leg.tip >= 0 && leg.tip != leg.toes) {
      Vec3 ahead = bone(leg.ankle, leg.toes);
      ahead.y() = 0;
      if (ahead.norm() > 1e-6 * figure_.stature) point(leg.toes, leg.tip, ahead, 35 * kDegree);
    }
  }

  void place_arm(std::size_t side) {
    const auto& arm = figure_.arms[side];
    const double out = side == 0 ? 1.0 : -1.0;
    if (arm.collar >= 0) {
      const Vec3 collar = bone(arm.collar, arm.shoulder);
      if (out * collar.x() < 0.3 * collar.norm()) {
        point(arm.collar, arm.shoulder, Vec3(out, 0.1, 0), 30 * kDegree);
      }
    }
    const Vec3 upper = bone(arm.shoulder, arm.elbow).normalized();
    const double hanging = angle(upper, -Vec3::UnitY());
    if (out * upper.x() < 0.45 || hanging > 102 * kDegree || std::abs(upper.z()) > 0.4) {
      // A raised or level arm goes to a T-pose, a hanging one half-way there.
      const double aim = hanging > 75 * kDegree ? 90 * kDegree : 45 * kDegree;
      point(arm.shoulder, arm.elbow, Vec3(out * std::sin(aim), -std::cos(aim), 0), 0);
    }
    point(arm.elbow, arm.wrist, bone(arm.shoulder, arm.elbow), 28 * kDegree);
    Vec3 knuckles = Vec3::Zero();
    int count = 0;
    for (const auto& chain : arm.fingers) {
      for (const int joint : chain) {
        const Vec3 offset = bone(arm.wrist, joint);
        if (offset.norm() < 0.02 * figure_.stature) continue;
        knuckles += offset.normalized();
        ++count;
        break;
      }
    }
    if (count == 0 || knuckles.norm() < 0.3 * count) return;
    const Vec3 forearm = bone(arm.elbow, arm.wrist);
    const double off = angle(knuckles, forearm);
    if (off > 30 * kDegree) {
      rotate(arm.wrist, shortest_arc(knuckles, forearm));
      turned_ += off;
    }
  }

  const Skeleton& skeleton_;
  const HumanFigure& figure_;
  std::vector<Transform> pose_;
  double turned_ = 0, heading_ = 0;
};

}  // namespace

StandingPose stand_upright(const Skeleton& skeleton, const HumanFigure& figure,
                           std::span<const Transform> pose) {
  return Straightener(skeleton, figure, pose).run();
}

}  // namespace krok::body
