#include <algorithm>
#include <cmath>

#include "math/quaternion.h"
#include "ragdoll/articulation_internal.h"

namespace krok::ragdoll {

void Articulation::place(double step, std::span<const Vec6> moving) {
  for (const Link& link : links_) {
    if (link.body < 0) continue;
    BodyState& state = states_[at(link.body)];
    const Vec6& twist = moving[at(link.body)];
    const Vec3 spin = twist.head<3>();
    if (link.joint < 0 || link.kinematic) {
      const Vec3 velocity = twist.tail<3>() + spin.cross(state.to_world.position);
      state.to_world.position += step * velocity;
      state.to_world.orientation =
          (from_rotation_vector(step * spin) * state.to_world.orientation).normalized();
      continue;
    }
    // Against the parent, whose speeds are those of the old pose, too.
    const Joint& joint = joints_[at(link.joint)];
    Ties& ties = ties_[at(link.joint)];
    Vec6 relative = twist;
    Quat old = joint.in_parent.orientation;
    if (joint.parent >= 0) {
      relative -= moving[at(joint.parent)];
      old = before_[at(joint.parent)].to_world.orientation * old;
    }
    const Vec3 turn = old.conjugate() * Vec3(relative.head<3>());
    if (link.freedom == Freedom::hinge) {
      ties.turned = (ties.turned * from_rotation_vector(Vec3(step * turn.x(), 0, 0))).normalized();
    } else if (link.freedom == Freedom::turn) {
      ties.turned = (from_rotation_vector(step * turn) * ties.turned).normalized();
    }
    if (ties.slide >= 0) {
      const Vec3 in_parent = this->anchor(link.joint);
      const Transform parent{
          joint.parent < 0 ? in_parent : before_[at(joint.parent)].to_world * in_parent, old};
      const Vec3 anchor = parent * ties.slid;
      const Vec3 speed =
          old.conjugate() * Vec3(relative.tail<3>() + Vec3(relative.head<3>()).cross(anchor));
      for (int i = 0; i < 3; ++i) {
        if (!links_[at(ties.slide)].axes.col(i).isZero()) ties.slid[i] += step * speed[i];
      }
    }
    ties.moved += step * anchor_speeds_[at(link.joint)];
    state.to_world =
        parent_frame(link.joint) * Transform{ties.slid, ties.turned} * joint.in_child.inverse();
    state.to_world.orientation.normalize();
  }
}

// A tree that nothing holds keeps its momenta; turning by parts of a circle would lose some. Its
// centre of mass goes straight on, and what its turning has lost it gets back as one body.
void Articulation::keep_momenta(double step, std::span<const Vec6> moving,
                                std::span<const BodyState> before) {
  for (std::size_t r = 0; r < links_.size(); ++r) {
    if (links_[r].freedom != Freedom::all || links_[r].kinematic) continue;
    double mass = 0;
    Vec3 old_centre = Vec3::Zero(), centre = Vec3::Zero();
    Vec3 path = Vec3::Zero(), path_before = Vec3::Zero();
    bool held = false;
    const auto each = [&](const auto& work) {
      for (std::size_t i = r; i < links_.size(); ++i) {
        if (links_[at(static_cast<int>(i))].root != static_cast<int>(r)) continue;
        held = held || links_[i].kinematic;
        if (links_[i].body >= 0) work(at(links_[i].body));
      }
    };
    each([&](std::size_t b) {
      const double m = masses_[b];
      const Vec3& x = before[b].to_world.position;
      const Vec3 spin = moving[b].head<3>();
      mass += m;
      old_centre += m * x;
      centre += m * states_[b].to_world.position;
      path_before += m * before[b].velocity;
      path += m * (moving[b].tail<3>() + spin.cross(x));
    });
    if (held) continue;
    old_centre /= mass;
    centre /= mass;
    Vec3 shift = old_centre + step * path / mass - centre;
    // In the air the speed of the whole step is the mean of that before and after.
    if ((path - path_before - mass * fallen_).norm() < 1e-9 * mass) shift -= 0.5 * step * fallen_;
    Vec3 lost = Vec3::Zero();
    Mat3 whole = Mat3::Zero();
    each([&](std::size_t b) {
      const double m = masses_[b];
      const Vec3 arm = states_[b].to_world.position - centre;
      lost += m * (before[b].to_world.position - old_centre - arm).cross(states_[b].velocity);
      whole += inertias_[b] + m * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    });
    const Vec3 spin = whole.inverse() * lost;
    if (!spin.allFinite()) continue;
    each([&](std::size_t b) {
      states_[b].velocity += spin.cross(states_[b].to_world.position - centre);
      states_[b].spin += spin;
      states_[b].to_world.position += shift;
    });
  }
}

void Articulation::move(double step, std::span<const Vec6> moving, std::span<const Vec6> left) {
  place(step, moving);
  for (std::size_t b = 0; b < states_.size(); ++b) {
    BodyState& state = states_[b];
    const Mat3 axes = state.to_world.orientation.toRotationMatrix();
    const Vec3 spin = left[b].head<3>();
    state.velocity = left[b].tail<3>() + spin.cross(before_[b].to_world.position);
    // The angular momentum stays, so the spin changes with the pose.
    const Vec3 momentum = inertias_[b] * spin;
    state.spin = axes * (axes.transpose() * momentum).cwiseQuotient(moments_[b]);
    inertias_[b].noalias() = axes * moments_[b].asDiagonal() * axes.transpose();
    if (links_[at(link_of_[b])].kinematic) state.spin = spin;
  }
  keep_momenta(step, moving, before_);
}

void Articulation::move_back() {
  states_ = before_;
  inertias_ = inertias_before_;
  ties_ = ties_before_;
}

double Articulation::gap(int joint) const {
  const Joint& its = joints_[at(joint)];
  const Frames now = frames(joint);
  const Vec3 apart = now.child.position - now.parent.position;
  if (its.kind == JointKind::distance) {
    if (its.soft) return 0;
    return std::max({0.0, apart.norm() - its.range.max, its.range.min - apart.norm()});
  }
  const Vec3 in_parent = now.parent.orientation.conjugate() * apart;
  Vec3 beyond = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    Range range{0, 0};
    if (its.kind == JointKind::prismatic && i == 0) range = its.range;
    if (its.kind == JointKind::six_dof) range = its.slide[at(i)];
    if (its.soft && range.min != range.max) continue;
    beyond[i] = std::max({0.0, in_parent[i] - range.max, range.min - in_parent[i]});
  }
  return beyond.norm();
}

double Articulation::excess(int joint) const {
  const Joint& its = joints_[at(joint)];
  if (its.soft) return 0;
  if (its.kind == JointKind::revolute) {
    const double angle = hinge_angle(joint);
    return std::max({0.0, angle - its.range.max, its.range.min - angle});
  }
  if (its.kind != JointKind::spherical && its.kind != JointKind::six_dof) return 0;
  const Frames now = frames(joint);
  return ik::excess(its.turn,
                    (now.parent.orientation.conjugate() * now.child.orientation).normalized());
}

}  // namespace krok::ragdoll
