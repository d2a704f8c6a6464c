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

// A free tree keeps its momenta, of which rotation in finite steps would lose some. Its centre of
// mass moves straight on, and the lost angular momentum is given back to the tree as one rigid
// body.
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
  ++pose_;
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
  ++pose_;
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
  const auto is_within = [](const LimitSide& side) { return side.beyond <= 0; };
  if (std::ranges::all_of(limit_sides(joint), is_within)) return 0;
  return ik::excess(its.turn, ties_[at(joint)].turned);
}

namespace {
constexpr double kSlow = 0.02;  // rad/s: below this, dry friction is less
}

// The joint's speeds as the bodies have them.
Vec3 Articulation::last_rate(const Link& link) const {
  const Joint& joint = joints_[at(link.joint)];
  Vec6 relative = body_twist(joint.child);
  if (joint.parent >= 0) relative -= body_twist(joint.parent);
  const Vec3 spin = relative.head<3>();
  if (link.freedom == Freedom::turn) return spin;
  if (link.freedom == Freedom::hinge) return {spin.dot(link.axes.col(0).head<3>()), 0, 0};
  const Vec3 anchor = parent_frame(link.joint) * ties_[at(link.joint)].slid;
  const Vec3 velocity = relative.tail<3>() + spin.cross(anchor);
  return link.axes.bottomRows<3>().transpose() * velocity;
}

// What acts within a joint: impulses over the step, and dampers as a part of its inertia.
void Articulation::drive(Link& link, double step, Mat3& damping) const {
  const Joint& joint = joints_[at(link.joint)];
  link.impulse.setZero();
  if (link.freedom == Freedom::slide) {
    if (joint.soft) soft_slide(link, step, damping);
    return;
  }
  // Dry friction stops within the step; a damper of the speed that there is stands for it.
  const double dry =
      joint.dry_friction > 0 ? joint.dry_friction / (last_rate(link).norm() + kSlow) : 0;
  damping.diagonal().array() += step * (joint.friction + dry);
  if (joint.soft) soft_turn(link, step, damping);
  if (joint.motor > 0) run_motor(link, step, damping);
}

// A spring and a damper, both as they will be at the end of the step (Tan et al., "Stable
// proportional-derivative controllers", 2011), which holds for any gain.
void Articulation::run_motor(Link& link, double step, Mat3& damping) const {
  const Joint& joint = joints_[at(link.joint)];
  const Transform parent = parent_frame(link.joint);
  const Quat child = parent.orientation * ties_[at(link.joint)].turned;
  Vec3 off = rotation_vector(parent.orientation * joint.target * child.conjugate());
  Vec3 speed = parent.orientation * joint.target_speed;
  if (link.freedom == Freedom::hinge) {
    const Vec3 axis = link.axes.col(0).head<3>();
    off = Vec3(axis.dot(off), 0, 0);
    speed = Vec3(axis.dot(speed), 0, 0);
  }
  const double stiffness = joint.motor_stiffness, damper = joint.motor_damping;
  // The spring asks for more than the motor can give: the motor gives its maximum, without the
  // stability of a spring.
  const Vec3 torque = stiffness * off + damper * (speed - last_rate(link));
  if (torque.norm() > joint.motor) {
    const double share = joint.motor / torque.norm();
    link.impulse += step * share * (stiffness * off + damper * speed);
    damping.diagonal().array() += step * share * damper + step * step * share * stiffness;
    return;
  }
  link.impulse += step * (stiffness * off + damper * speed);
  damping.diagonal().array() += step * damper + step * step * stiffness;
}

// `axis` is in the joint's coordinates, the way out of the range. The spring's impulse is that over
// the step about this moment, in a part of which it may be within the range.
void Articulation::spring(Link& link, const Vec3& axis, double beyond, double step,
                          Mat3& damping) const {
  const Joint& joint = joints_[at(link.joint)];
  const double speed = axis.dot(last_rate(link));
  const double far = beyond + 0.5 * step * std::abs(speed);
  if (far <= 0) return;
  const double heavy = axis.dot(link.inverse * axis);
  if (step * step * joint.stiffness > 0.5 * heavy) {
    // Too stiff for the step: taken as it will be at the end of the step.
    if (beyond <= 0) return;
    const double damper = joint.damping + step * joint.stiffness;
    link.impulse -= step * joint.stiffness * beyond * axis;
    damping += step * damper * axis * axis.transpose();
    return;
  }
  const double near = beyond - 0.5 * step * std::abs(speed);
  const double time = near >= 0 ? step : far / std::abs(speed);
  const double push = joint.stiffness * (near >= 0 ? step * beyond : 0.5 * far * time);
  double damper = joint.damping * time;
  // It pushes, but does not pull.
  if (speed < 0) damper = std::min(damper, push / -speed);
  link.impulse -= (push + 0.5 * damper * speed) * axis;
  damping += 0.5 * damper * axis * axis.transpose();
}

void Articulation::soft_turn(Link& link, double step, Mat3& damping) const {
  const Joint& joint = joints_[at(link.joint)];
  if (link.freedom == Freedom::hinge) {
    const double angle = hinge_angle(link.joint);
    spring(link, Vec3::UnitX(), angle - joint.range.max, step, damping);
    spring(link, -Vec3::UnitX(), joint.range.min - angle, step, damping);
    return;
  }
  for (const LimitSide& side : limit_sides(link.joint)) {
    spring(link, side.axis, side.beyond, step, damping);
  }
}

void Articulation::soft_slide(Link& link, double step, Mat3& damping) const {
  const Joint& joint = joints_[at(link.joint)];
  for (int i = 0; i < 3; ++i) {
    if (link.axes.col(i).isZero()) continue;
    const Range& range = joint.kind == JointKind::prismatic ? joint.range : joint.slide[at(i)];
    const double slid = slide(link.joint, i);
    spring(link, Vec3::Unit(i), slid - range.max, step, damping);
    spring(link, -Vec3::Unit(i), range.min - slid, step, damping);
  }
}

// Springs to outside, both parts as they will be at the end of the step, as those of motors.
void Articulation::pull_held(double step) {
  for (const auto& [body, hold] : holds_) {
    Link& link = links_[at(link_of_[at(body)])];
    if (link.freedom != Freedom::all || link.kinematic) continue;
    const BodyState& state = states_[at(body)];
    Vec6 pull = spatial(
        hold.turn_stiffness *
            rotation_vector(hold.target.orientation * state.to_world.orientation.conjugate()),
        hold.stiffness * (hold.target.position - state.to_world.position));
    pull += spatial(hold.turn_damping * hold.spin, hold.damping * hold.velocity);
    const Vec6 now = pull - spatial(hold.turn_damping * state.spin, hold.damping * state.velocity);
    const auto share = [](double asked, double most) { return asked > most ? most / asked : 1.0; };
    const double turn = share(now.head<3>().norm(), hold.max_torque);
    const double shift = share(now.tail<3>().norm(), hold.max_force);
    Vec6 damping;
    damping.head<3>().setConstant(step * turn * (hold.turn_damping + step * hold.turn_stiffness));
    damping.tail<3>().setConstant(step * shift * (hold.damping + step * hold.stiffness));
    // From the twist about the origin to spin and velocity of the centre.
    Mat6 to_centre = Mat6::Identity();
    const Vec3& c = state.to_world.position;
    to_centre.bottomLeftCorner<3, 3>() << 0, c.z(), -c.y(), -c.z(), 0, c.x(), c.y(), -c.x(), 0;
    link.inertia += to_centre.transpose() * damping.asDiagonal() * to_centre;
    link.momentum +=
        to_centre.transpose() * step *
        spatial(turn * pull.head<3>() + hold.support_torque, shift * pull.tail<3>() + hold.support);
  }
}

void Articulation::hold(int body, const Hold& hold) {
  for (auto& [held, its] : holds_) {
    if (held == body) {
      its = hold;
      return;
    }
  }
  holds_.emplace_back(body, hold);
}

// Soft distances, which are no part of the tree.
void Articulation::hold_distances(double step) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    if (joint.kind != JointKind::distance || !joint.soft) continue;
    const Frames its = frames(static_cast<int>(j));
    const Vec3 apart = its.child.position - its.parent.position;
    const double length = apart.norm();
    if (length < 1e-9) continue;
    const double beyond = length > joint.range.max   ? length - joint.range.max
                          : length < joint.range.min ? length - joint.range.min
                                                     : 0.0;
    if (beyond == 0) continue;
    const auto velocity = [](const BodyState& state, const Vec3& point) {
      return Vec3(state.velocity + state.spin.cross(point - state.to_world.position));
    };
    const Vec3 axis = apart / length;
    // What an impulse along the axis at a point of a body gives it; none if it is kinematic.
    const auto answer = [&](int body, const Vec3& point) {
      const Vec3 turn = (point - states_[at(body)].to_world.position).cross(axis);
      return is_kinematic(body)
                 ? Vec6(Vec6::Zero())
                 : spatial(inertias_[at(body)].inverse() * turn, axis / masses_[at(body)]);
    };
    BodyState& child = states_[at(joint.child)];
    const Vec6 of_child = answer(joint.child, its.child.position);
    const auto along = [&](const Vec6& of, const BodyState& body, const Vec3& point) {
      return axis.dot(of.tail<3>() + Vec3(of.head<3>()).cross(point - body.to_world.position));
    };
    double speed = axis.dot(velocity(child, its.child.position));
    double give = along(of_child, child, its.child.position);
    BodyState* parent = joint.parent < 0 ? nullptr : &states_[at(joint.parent)];
    Vec6 of_parent = Vec6::Zero();
    if (parent != nullptr) {
      of_parent = answer(joint.parent, its.parent.position);
      speed -= axis.dot(velocity(*parent, its.parent.position));
      give += along(of_parent, *parent, its.parent.position);
    }
    if (give <= 0) continue;
    const double stiffness = std::min(joint.stiffness, 0.5 / (step * step * give));
    const double impulse =
        -step * (stiffness * beyond + joint.damping * speed) / (1 + step * joint.damping * give);
    if (impulse * beyond > 0) continue;
    child.velocity += impulse * of_child.tail<3>();
    child.spin += impulse * of_child.head<3>();
    if (parent == nullptr) continue;
    parent->velocity -= impulse * of_parent.tail<3>();
    parent->spin -= impulse * of_parent.head<3>();
  }
}

}  // namespace krok::ragdoll
