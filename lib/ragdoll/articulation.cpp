#include <algorithm>
#include <cmath>
#include <utility>

#include "math/quaternion.h"
#include "ragdoll/articulation_internal.h"

namespace krok::ragdoll {

namespace {

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Of a body with its centre at `centre`, about the origin.
Mat6 spatial_inertia(double mass, const Mat3& inertia, const Vec3& centre) {
  Mat6 whole;
  const Mat3 arm = mass * cross_matrix(centre);
  whole.topLeftCorner<3, 3>() =
      inertia + mass * (centre.squaredNorm() * Mat3::Identity() - centre * centre.transpose());
  whole.topRightCorner<3, 3>() = arm;
  whole.bottomLeftCorner<3, 3>() = -arm;
  whole.bottomRightCorner<3, 3>() = mass * Mat3::Identity();
  return whole;
}

bool slides(const Joint& joint) {
  return joint.kind == JointKind::six_dof &&
         std::ranges::any_of(joint.slide, [](const Range& r) { return r.min < r.max; });
}

}  // namespace

Vec3 moments_of_inertia(const Body& body) {
  const Shape& shape = body.shape;
  const double m = body.mass, r = shape.radius, square = r * r;
  if (shape.kind == Shape::Kind::box) {
    const Vec3 s = shape.half.cwiseProduct(shape.half);
    return m / 3 * Vec3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
  }
  if (shape.kind == Shape::Kind::sphere) return Vec3::Constant(0.4 * m * square);
  // A cylinder and two half spheres, whose centres of mass are 3/8 of the radius beyond its ends.
  const double h = shape.half_length, whole = volume(shape);
  const double tube = m * kPi * square * 2 * h / whole, caps = m - tube;
  const double along = 0.5 * tube * square + 0.4 * caps * square;
  const double across =
      tube * (square / 4 + h * h / 3) + caps * (0.4 * square + h * h + 0.75 * h * r);
  return {across, along, across};
}

Status Articulation::build(std::span<const Body> bodies, std::span<const BodyState> states,
                           std::span<const Joint> joints) {
  states_.assign(states.begin(), states.end());
  joints_.assign(joints.begin(), joints.end());
  ties_.resize(joints_.size());
  limit_sides_.resize(joints_.size());
  sides_of_pose_.assign(joints_.size(), -1);
  anchor_speeds_.assign(joints_.size(), Vec3::Zero());
  twists_.resize(bodies.size(), Vec6::Zero());
  link_of_.assign(bodies.size(), -1);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    masses_.push_back(bodies[b].mass);
    moments_.push_back(moments_of_inertia(bodies[b]));
    states_[b].to_world.orientation.normalize();
  }
  std::vector<int> joint_of(bodies.size(), -1);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].kind == JointKind::distance) continue;
    int& own = joint_of[at(joints[j].child)];
    if (own >= 0) return Error("ragdoll-value", "a body is the child of two joints");
    own = static_cast<int>(j);
  }
  std::vector<bool> added(bodies.size(), false);
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    int steps = 0;
    for (int up = b; joint_of[at(up)] >= 0 && joints[at(joint_of[at(up)])].parent >= 0;) {
      up = joints[at(joint_of[at(up)])].parent;
      if (++steps > body_count()) return Error("ragdoll-value", "the joints form a ring");
    }
    add_links(b, joint_of, added);
  }
  for (const Link& link : links_) {
    if (link.joint >= 0 && link.body >= 0) take_up(link.joint);
  }
  inertias_.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Mat3 axes = states_[b].to_world.orientation.toRotationMatrix();
    inertias_[b] = axes * moments_[b].asDiagonal() * axes.transpose();
  }
  for (Link& link : links_) {
    link.number = freedom_count_;
    freedom_count_ += link.freedom == Freedom::all ? 6 : link.freedom == Freedom::none ? 0 : 3;
  }
  return {};
}

// The body's link after those above it.
void Articulation::add_links(int body, std::span<const int> joint_of, std::vector<bool>& added) {
  if (added[at(body)]) return;
  added[at(body)] = true;
  const int joint = joint_of[at(body)];
  if (joint >= 0 && joints_[at(joint)].parent >= 0) {
    add_links(joints_[at(joint)].parent, joint_of, added);
  }
  add_joint_links(body, joint);
}

void Articulation::add_joint_links(int body, int joint) {
  Link link;
  link.body = body;
  link.joint = joint;
  const auto add = [&](const Link& made) {
    links_.push_back(made);
    const int number = static_cast<int>(links_.size()) - 1;
    links_.back().root = made.parent < 0 ? number : links_[at(made.parent)].root;
    return number;
  };
  if (joint < 0) {
    link_of_[at(body)] = add(link);
    return;
  }
  const Joint& its = joints_[at(joint)];
  link.parent = its.parent < 0 ? -1 : link_of_[at(its.parent)];
  if (slides(its)) {
    Link between = link;
    between.body = -1;
    between.freedom = Freedom::slide;
    ties_[at(joint)].slide = link.parent = add(between);
  }
  const bool locked = its.turn.kind == ik::JointLimit::Kind::locked;
  link.freedom = its.kind == JointKind::revolute          ? Freedom::hinge
                 : its.kind == JointKind::prismatic       ? Freedom::slide
                 : its.kind == JointKind::fixed || locked ? Freedom::none
                                                          : Freedom::turn;
  link_of_[at(body)] = add(link);
  (link.freedom == Freedom::slide ? ties_[at(joint)].slide : ties_[at(joint)].turn) =
      link_of_[at(body)];
}

Transform Articulation::parent_frame(int joint) const {
  const Joint& its = joints_[at(joint)];
  const Transform in_parent{anchor(joint), its.in_parent.orientation};
  return its.parent < 0 ? in_parent : states_[at(its.parent)].to_world * in_parent;
}

// Where the child is in its joint, and its place from that.
void Articulation::take_up(int joint) {
  const Joint& its = joints_[at(joint)];
  Ties& ties = ties_[at(joint)];
  const Transform parent = parent_frame(joint);
  BodyState& child = states_[at(its.child)];
  const Transform relative = parent.inverse() * (child.to_world * its.in_child);
  ties.turned = relative.orientation.normalized();
  if (its.kind == JointKind::revolute) {
    ties.turned = Quat(ties.turned.w(), ties.turned.x(), 0, 0).normalized();
  }
  if (its.kind == JointKind::prismatic) ties.slid.x() = relative.position.x();
  if (its.kind == JointKind::six_dof) {
    for (int i = 0; i < 3; ++i) {
      const Range& range = its.slide[at(i)];
      ties.slid[i] = range.min < range.max ? relative.position[i] : range.min;
    }
  }
  child.to_world = parent * Transform{ties.slid, ties.turned} * its.in_child.inverse();
  child.to_world.orientation.normalize();
}

void Articulation::set_kinematic(int body, bool kinematic) {
  links_[at(link_of_[at(body)])].kinematic = kinematic;
}

Articulation::Frames Articulation::frames(int joint) const {
  const Joint& its = joints_[at(joint)];
  return {parent_frame(joint), states_[at(its.child)].to_world * its.in_child};
}

double Articulation::hinge_angle(int joint) const {
  const Quat& turned = ties_[at(joint)].turned;
  const Range& range = joints_[at(joint)].range;
  const double angle = 2 * std::atan2(turned.x(), turned.w());
  const double middle = std::isfinite(range.min + range.max) ? 0.5 * (range.min + range.max) : 0.0;
  return angle - 2 * kPi * std::round((angle - middle) / (2 * kPi));
}

std::span<const Articulation::LimitSide> Articulation::limit_sides(int joint) const {
  std::vector<LimitSide>& sides = limit_sides_[at(joint)];
  if (std::exchange(sides_of_pose_[at(joint)], pose_) == pose_) return sides;
  sides.clear();
  const Joint& its = joints_[at(joint)];
  const Mat3 axes =
      (states_[at(its.child)].to_world.orientation * its.in_child.orientation).toRotationMatrix();
  if (its.kind == JointKind::revolute) {
    const double angle = hinge_angle(joint);
    sides.push_back({0, axes.col(0), angle - its.range.max});
    sides.push_back({1, -axes.col(0), its.range.min - angle});
    return sides;
  }
  const bool turns = its.kind == JointKind::spherical || its.kind == JointKind::six_dof;
  if (!turns || its.turn.kind != ik::JointLimit::Kind::cone) return sides;
  const Quat& turned = ties_[at(joint)].turned;
  const ik::LimitAngles angles = ik::measure(its.turn, turned);
  const ik::LimitGradients slopes = ik::gradients(its.turn, turned);
  const double twist = slopes.twist.norm();
  if (its.turn.max_twist - its.turn.min_twist < 2 * kPi && twist > 1e-6) {
    const Vec3 axis = axes * slopes.twist / twist;
    sides.push_back({0, axis, (angles.twist - its.turn.max_twist) / twist});
    sides.push_back({1, -axis, (its.turn.min_twist - angles.twist) / twist});
  }
  double ratio = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    const double swing = angles.swing[k];
    const double half = swing < 0 ? -its.turn.min_swing[k] : its.turn.max_swing[k];
    ratio = std::hypot(ratio, swing / std::max(half, 1e-6));
  }
  const double swing = slopes.swing.norm();
  // The slopes are those of the square of the ratio.
  if (swing > 1e-6) {
    sides.push_back({2, axes * slopes.swing / swing, 2 * ratio * (ratio - 1) / swing});
  }
  return sides;
}

double Articulation::slide(int joint, int axis) const {
  return ties_[at(joint)].slid[axis];
}

double Articulation::max_spin() const {
  double most = 0;
  for (const BodyState& state : states_) most = std::max(most, state.spin.norm());
  return most;
}

void Articulation::push(int body, const Vec3& impulse) {
  if (is_kinematic(body)) return;
  states_[at(body)].velocity += impulse / masses_[at(body)];
}

Vec6 Articulation::body_twist(int body) const {
  const BodyState& state = states_[at(body)];
  return spatial(state.spin, state.velocity - state.spin.cross(state.to_world.position));
}

void Articulation::set_axes(Link& link) const {
  if (link.joint < 0 || link.freedom == Freedom::none) return;
  const Joint& joint = joints_[at(link.joint)];
  const Transform parent = parent_frame(link.joint);
  if (link.freedom == Freedom::slide) {
    for (int i = 0; i < 3; ++i) {
      const bool free = joint.kind == JointKind::prismatic
                            ? i == 0
                            : joint.slide[at(i)].min < joint.slide[at(i)].max;
      if (free) link.axes.col(i) = spatial(Vec3::Zero(), parent.orientation * Vec3(Vec3::Unit(i)));
    }
    return;
  }
  const Vec3 anchor = parent * ties_[at(link.joint)].slid;
  if (link.freedom == Freedom::hinge) {
    const Vec3 axis = parent.orientation * Vec3(Vec3::UnitX());
    link.axes.col(0) = spatial(axis, anchor.cross(axis));
    return;
  }
  link.axes.topRows<3>().setIdentity();
  link.axes.bottomRows<3>() = cross_matrix(anchor);
}

// By the first of the joint's links alone.
void Articulation::set_drift(int number) {
  Link& link = links_[at(number)];
  if (link.joint < 0) return;
  const Joint& joint = joints_[at(link.joint)];
  const int slide = ties_[at(link.joint)].slide;
  if (slide >= 0 && slide != number) return;
  const Vec3& speed = anchor_speeds_[at(link.joint)];
  link.drift =
      spatial(Vec3::Zero(),
              joint.parent < 0 ? speed : states_[at(joint.parent)].to_world.orientation * speed);
}

void Articulation::gather(double step, const Vec3& gravity) {
  for (Link& link : links_) {
    set_axes(link);
    link.inertia.setZero();
    link.momentum.setZero();
    if (link.body < 0) continue;
    const std::size_t b = at(link.body);
    const BodyState& state = states_[b];
    if (link.kinematic) {
      link.twist = body_twist(link.body);
      continue;
    }
    const Vec3& centre = state.to_world.position;
    const Vec3 impulse = masses_[b] * (state.velocity + step * gravity);
    link.inertia = spatial_inertia(masses_[b], inertias_[b], centre);
    link.momentum = spatial(inertias_[b] * state.spin + centre.cross(impulse), impulse);
  }
}

// Leaves to roots: what a link and those below it weigh against a movement of the link above.
void Articulation::eliminate(double step) {
  for (std::size_t i = links_.size(); i-- > 0;) {
    Link& link = links_[i];
    if (link.kinematic || link.freedom == Freedom::all) continue;
    if (!link.drift.isZero(0)) link.momentum.noalias() -= link.inertia * link.drift;
    Link* above = link.parent < 0 ? nullptr : &links_[at(link.parent)];
    if (link.freedom == Freedom::none) {
      if (above != nullptr) {
        above->inertia += link.inertia;
        above->momentum += link.momentum;
      }
      continue;
    }
    link.coupling.noalias() = link.inertia * link.axes;
    Mat3 joint = link.axes.transpose() * link.coupling;
    for (int k = 0; k < 3; ++k) {
      if (link.axes.col(k).isZero()) joint(k, k) = 1;
    }
    Mat3 damping = Mat3::Zero();
    link.inverse = joint;  // drive() sees how heavy the joint is
    drive(link, step, damping);
    link.inverse = (joint + damping).inverse();
    link.gain.noalias() = link.inverse * link.coupling.transpose();
    if (above == nullptr) continue;
    const Vec3 given = link.axes.transpose() * link.momentum + link.impulse;
    above->inertia += link.inertia;
    above->inertia.noalias() -= link.coupling * link.gain;
    above->momentum += link.momentum;
    above->momentum.noalias() -= link.gain.transpose() * given;
  }
}

void Articulation::distribute() {
  for (Link& link : links_) {
    if (link.freedom == Freedom::all && !link.kinematic) {
      link.free = link.inertia.llt().solve(Mat6::Identity());
      link.twist.noalias() = link.free * link.momentum;
    } else if (!link.kinematic) {
      link.twist = link.parent < 0 ? Vec6(Vec6::Zero()) : links_[at(link.parent)].twist;
      if (link.freedom != Freedom::none) {
        const Vec3 given = link.axes.transpose() * link.momentum + link.impulse;
        const Vec3 rate = link.inverse * given - link.gain * link.twist;
        link.twist += link.axes * rate;
      }
      link.twist += link.drift;
    }
    if (link.body >= 0) twists_[at(link.body)] = link.twist;
  }
}

void Articulation::accelerate(double step, const Vec3& gravity) {
  before_ = states_;
  inertias_before_ = inertias_;
  ties_before_ = ties_;
  fallen_ = step * gravity;
  hold_distances(step);
  for (int i = 0; i < static_cast<int>(links_.size()); ++i) set_drift(i);
  gather(step, gravity);
  pull_held(step);
  eliminate(step);
  distribute();
}

void Articulation::answer(std::span<const Vec6> wrenches, std::vector<Vec6>& twists) const {
  std::vector<Vec6> sums(links_.size(), Vec6::Zero());  // wrenches, then twists
  for (std::size_t b = 0; b < wrenches.size(); ++b) sums[at(link_of_[b])] = wrenches[b];
  for (std::size_t i = links_.size(); i-- > 0;) {
    const Link& link = links_[i];
    if (link.kinematic || link.parent < 0) continue;
    Vec6& above = sums[at(link.parent)];
    above += sums[i];
    if (link.freedom == Freedom::none) continue;
    above.noalias() -= link.gain.transpose() * Vec3(link.axes.transpose() * sums[i]);
  }
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    const Vec6 wrench = sums[i];
    sums[i] = link.parent < 0 || link.kinematic ? Vec6(Vec6::Zero()) : sums[at(link.parent)];
    if (!link.kinematic && link.freedom == Freedom::all) {
      sums[i].noalias() = link.free * wrench;
    } else if (!link.kinematic && link.freedom != Freedom::none) {
      const Vec3 rate = link.inverse * Vec3(link.axes.transpose() * wrench) - link.gain * sums[i];
      sums[i].noalias() += link.axes * rate;
    }
    if (link.body >= 0) twists[at(link.body)] = link.twist + sums[i];
  }
}

}  // namespace krok::ragdoll
