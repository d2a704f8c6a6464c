#include "ragdoll/toes.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/index.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "roles/body_frame.h"

namespace krok::ragdoll {

namespace {

constexpr double kMaxBent = 80 * kRadiansPerDegree;
constexpr double kFastest = 600 * kRadiansPerDegree;  // per second; they begin before they have to
constexpr double kTurnedOver = 0.2;                   // the upward part of the way to the shin

struct Toes {
  int joint = -1, tip = -1;
  std::vector<int> below;    // with the joint
  Vec3 along, towards_shin;  // unit, in the joint's frame, at right angles
};

// Of the joints at the balls of both feet, with what is farthest below them.
std::vector<Toes> find_toes(const Skeleton& skeleton, const RoleMap& roles,
                            const std::vector<Body>& bodies) {
  const Vec3 up = body_frame(skeleton, roles) * Vec3::UnitY();
  const auto place = [&](int joint) { return skeleton.reference[at(joint)].position; };
  std::vector<Toes> all;
  for (const Role role : {Role::left_toes, Role::right_toes}) {
    for (const int joint : roles.joints(role)) {
      const int foot = roles.joint(role == Role::left_toes ? Role::left_foot : Role::right_foot);
      const bool has_body = std::ranges::find(bodies, joint, &Body::joint) != bodies.end();
      if (skeleton.parents[at(joint)] != foot || has_body) continue;
      Toes toes;
      toes.joint = joint;
      double farthest = 0;
      const auto within = subtree(skeleton, joint);
      for (int j = joint; j < skeleton.joint_count(); ++j) {
        if (within[at(j)] == 0) continue;
        toes.below.push_back(j);
        const double far = (place(j) - place(joint)).norm();
        if (far > farthest) {
          farthest = far;
          toes.tip = j;
        }
      }
      if (toes.tip < 0) continue;
      const Vec3 along = (place(toes.tip) - place(joint)).normalized();
      const Vec3 towards = up - up.dot(along) * along;
      if (!(towards.norm() > 0.1)) continue;
      const Quat to_joint = skeleton.reference[at(joint)].orientation.conjugate();
      toes.along = to_joint * along;
      toes.towards_shin = to_joint * towards.normalized();
      all.push_back(std::move(toes));
    }
  }
  return all;
}

// The least angle towards the shin by which a tip at `length` comes to `height` over the joint.
double needed(const Vec3& along, const Vec3& towards, double length, double height) {
  // Its height at an angle is length * size * cos(angle - best).
  const double size = std::hypot(along.y(), towards.y()), best = std::atan2(towards.y(), along.y());
  if (length * along.y() >= height || best <= 0 || !(size > 0)) return 0;
  const double off = std::acos(std::clamp(height / (length * size), -1.0, 1.0));
  // Less and less for a foot that turns over onto its instep, where no angle helps.
  const double helps = std::min(1.0, towards.y() / kTurnedOver);
  return helps * std::clamp(best - off, 0.0, kMaxBent);
}

// The least angles of at least these that change by no more than `step` from one to the next.
void limit_steps(double step, std::span<double> angles) {
  for (std::size_t i = 1; i < angles.size(); ++i) {
    angles[i] = std::max(angles[i], angles[i - 1] - step);
  }
  for (std::size_t i = angles.size(); i-- > 1;) {
    angles[i - 1] = std::max(angles[i - 1], angles[i] - step);
  }
}

}  // namespace

void bend_toes(int first_frame, const RoleMap& roles, const std::vector<Body>& bodies,
               const GroundHeight& ground, Clip& clip) {
  const int first = std::max(0, first_frame);
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (const Toes& toes : find_toes(clip.skeleton, roles, bodies)) {
    std::vector<double> angles(at(clip.frame_count() - first), 0.0);
    for (int f = first; f < clip.frame_count(); ++f) {
      const Vec3 tip = clip.frame_positions(f)[at(toes.tip)].cast<double>();
      const Vec3 ball = clip.frame_positions(f)[at(toes.joint)].cast<double>();
      const auto floor = ground(tip.x(), tip.z());
      const double length = (tip - ball).norm();
      // What is far over the toes is a roof, or out of their reach.
      if (!floor || tip.y() >= *floor || *floor - ball.y() > 2 * length) continue;
      const Quat turn = clip.frame_orientations(f)[at(toes.joint)].cast<double>();
      angles[at(f - first)] =
          needed(turn * toes.along, turn * toes.towards_shin, length, *floor - ball.y());
    }
    limit_steps(kFastest / clip.rate, angles);
    for (int f = first; f < clip.frame_count(); ++f) {
      const double angle = angles[at(f - first)];
      if (angle == 0) continue;
      clip.get_pose(f, pose);
      const Transform ball = pose[at(toes.joint)];
      const Vec3 axis = ball.orientation * toes.along.cross(toes.towards_shin);
      const Quat turn(Eigen::AngleAxisd(angle, axis));
      for (const int j : toes.below) {
        Transform& joint = pose[at(j)];
        joint = {ball.position + turn * (joint.position - ball.position), turn * joint.orientation};
      }
      clip.set_pose(f, pose);
    }
  }
}

}  // namespace krok::ragdoll
