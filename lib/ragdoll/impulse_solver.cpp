#include "ragdoll/impulse_solver_internal.h"

#include <algorithm>
#include <cmath>

#include "ragdoll/articulation_internal.h"

namespace krok::ragdoll {

namespace {

// The share of a penetration that is taken back in a step, and the fastest, m/s or rad/s.
constexpr double kTakeBack = 0.2, kFastestBack = 0.5, kFastestTurnBack = 12;
// Normals with a larger cosine count as one plane.
constexpr double kSamePlane = 0.95;
// What rows may miss by turning within a step, radians and metres.
constexpr double kMissedAngle = 0.002, kMissedGap = 0.0005;
// Slower than this nothing bounces, m/s.
constexpr double kBounces = 0.2;

// Two directions across a unit vector, always the same for the same one.
std::array<Vec3, 2> across(const Vec3& normal) {
  const Vec3 side = std::abs(normal.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitZ();
  const Vec3 first = (side - side.dot(normal) * normal).normalized();
  return {first, normal.cross(first)};
}

Vec6 wrench_at(const Vec3& point, const Vec3& force) {
  return spatial(point.cross(force), force);
}

}  // namespace

void ImpulseSolver::begin(const Articulation& bodies, double step) {
  bodies_ = &bodies;
  step_ = step;
  rows_.clear();
  groups_.clear();
  patches_.clear();
  moving_ = left_ = bodies.twists();
}

void ImpulseSolver::open_group(int a, int b) {
  const bool open = !groups_.empty() && groups_.back().a == a && groups_.back().b == b &&
                    groups_.back().patch < 0;
  if (!open) groups_.push_back({a, b, rows_.size(), rows_.size(), -1});
}

ImpulseSolver::Row& ImpulseSolver::add_row(const Vec6& wrench) {
  rows_.emplace_back().wrench = wrench;
  groups_.back().end = rows_.size();
  return rows_.back();
}

double ImpulseSolver::speed_along(const Group& group, const Vec6& wrench) const {
  const std::vector<Vec6>& twists = bodies_->twists();
  const double speed = wrench.dot(twists[at(group.a)]);
  return group.b < 0 ? speed : speed - wrench.dot(twists[at(group.b)]);
}

// The last row's gap may close within the step; below 0 it opens.
void ImpulseSolver::add_gap(double gap, double fastest) {
  Row& row = rows_.back();
  row.target = gap > 0 ? -gap / step_ : std::min(-gap * kTakeBack / step_, fastest);
  row.kept = gap > 0 ? row.target : 0;
  row.gap = gap;
  row.asked = std::min(0.0, gap + step_ * row.target);
}

void ImpulseSolver::add_contacts(std::span<const Contact> contacts, double friction,
                                 double restitution) {
  contacts_ = contacts;
  for (std::size_t first = 0; first < contacts.size();) {
    const Contact& leader = contacts[first];
    std::size_t end = first + 1;
    while (end < contacts.size() && contacts[end].a == leader.a && contacts[end].b == leader.b &&
           contacts[end].normal.dot(leader.normal) > kSamePlane) {
      ++end;
    }
    if (!bodies_->is_fixed(leader.a, leader.b))
      add_patch(contacts.subspan(first, end - first), friction, restitution);
    first = end;
  }
}

void ImpulseSolver::add_patch(std::span<const Contact> contacts, double friction,
                              double restitution) {
  const Contact& leader = contacts.front();
  groups_.push_back({leader.a, leader.b, rows_.size(), rows_.size(), -1});
  Patch patch;
  patch.first = rows_.size();
  patch.friction = static_cast<float>(friction);
  std::vector<Vec3> points;
  Vec3 pressed = Vec3::Zero(), middle = Vec3::Zero();
  double pressure = 0;
  for (const Contact& contact : contacts) {
    const Vec3 a = bodies_->state(contact.a).to_world * contact.on_a;
    const Vec3 b = contact.b < 0 ? contact.on_b : bodies_->state(contact.b).to_world * contact.on_b;
    const double gap = contact.normal.dot(a - b);
    const Vec3 point = 0.5 * (a + b);
    const Vec6 wrench = wrench_at(point, contact.normal);
    const double speed = speed_along(groups_.back(), wrench);
    // Farther than it could come, however it turns.
    if (gap + step_ * speed > 0.02) continue;
    Row& row = add_row(wrench);
    row.cache = contact.impulses[0];
    row.contact = static_cast<int>(&contact - contacts_.data());
    add_gap(gap, kFastestBack);
    if (restitution > 0 && speed < -kBounces && gap + step_ * speed < 0) {
      row.target = row.kept = std::max(row.target, -restitution * speed);
    }
    points.push_back(point);
    middle += point;
    pressed += static_cast<double>(*row.cache) * point;
    pressure += static_cast<double>(*row.cache);
  }
  if (points.empty()) {
    groups_.pop_back();
    return;
  }
  patch.end = rows_.size();
  const Vec3 centre =
      pressure > 0 ? Vec3(pressed / pressure) : Vec3(middle / static_cast<double>(points.size()));
  for (const Vec3& point : points)
    patch.arms.push_back(static_cast<float>((point - centre).norm()));
  const auto sides = across(leader.normal);
  for (std::size_t k = 0; k < 2; ++k) {
    add_row(wrench_at(centre, sides[k])).cache = leader.impulses[k + 1];
  }
  // About one point, friction has no arm.
  if (points.size() > 1) add_row(spatial(leader.normal, Vec3::Zero()));
  groups_.back().patch = static_cast<int>(patches_.size());
  patches_.push_back(std::move(patch));
}

// A limit about `axis` (world, the way out of the range), exceeded by `beyond` radians, or not yet.
void ImpulseSolver::add_limit(int joint, int side, const Vec3& axis, double beyond) {
  const Joint& its = bodies_->joint(joint);
  const Group group{its.child, its.parent, 0, 0, -1};
  const Vec6 wrench = spatial(-axis, Vec3::Zero());
  // What hits the ground may turn 50 rad/s faster within the step.
  if (step_ * speed_along(group, wrench) - beyond > 50 * step_) return;
  open_group(its.child, its.parent);
  Row& row = add_row(wrench);
  row.joint = joint;
  row.side = side;
  add_gap(-beyond, kFastestTurnBack);
}

void ImpulseSolver::add_slide(int joint, const Vec3& axis, double beyond) {
  const Joint& its = bodies_->joint(joint);
  open_group(its.child, its.parent);
  add_row(wrench_at(bodies_->frames(joint).child.position, -axis));
  add_gap(-beyond, kFastestBack);
}

void ImpulseSolver::add_slides(int joint) {
  const Joint& its = bodies_->joint(joint);
  const bool one = its.kind == JointKind::prismatic;
  for (int i = 0; i < (one ? 1 : 3); ++i) {
    const Range& range = one ? its.range : its.slide[at(i)];
    if (!one && range.min == range.max) continue;
    const Vec3 axis = bodies_->frames(joint).parent.orientation * Vec3(Vec3::Unit(i));
    const double slid = bodies_->slide(joint, i);
    if (std::isfinite(range.max)) add_slide(joint, axis, slid - range.max);
    if (std::isfinite(range.min)) add_slide(joint, -axis, range.min - slid);
  }
}

void ImpulseSolver::add_distance(int joint) {
  const Joint& its = bodies_->joint(joint);
  const auto frames = bodies_->frames(joint);
  const Vec3 apart = frames.child.position - frames.parent.position;
  const double length = apart.norm();
  if (length < 1e-9) return;
  const Vec3 axis = apart / length;
  if (its.range.min == its.range.max) {
    open_group(its.child, its.parent);
    Row& row = add_row(wrench_at(frames.child.position, axis));
    row.both = true;
    row.target = (its.range.min - length) * kTakeBack / step_;
    return;
  }
  if (std::isfinite(its.range.max)) add_slide(joint, axis, length - its.range.max);
  if (its.range.min > 0) add_slide(joint, -axis, its.range.min - length);
}

void ImpulseSolver::add_limits() {
  for (int j = 0; j < bodies_->joint_count(); ++j) {
    const Joint& joint = bodies_->joint(j);
    if (joint.soft || bodies_->is_fixed(joint.child, joint.parent)) continue;
    if (joint.kind == JointKind::distance) {
      add_distance(j);
      continue;
    }
    if (joint.kind == JointKind::prismatic || joint.kind == JointKind::six_dof) add_slides(j);
    for (const auto& side : bodies_->limit_sides(j))
      add_limit(j, side.number, side.axis, side.beyond);
  }
}

bool ImpulseSolver::missed() {
  bool any = false;
  for (const Group& group : groups_) {
    for (std::size_t r = group.first; r < group.end; ++r) any |= aim_again(group, rows_[r]);
  }
  return any;
}

bool ImpulseSolver::aim_again(const Group& group, Row& row) {
  double gap = 0, most = 0;
  Vec6 wrench = row.wrench;
  if (row.joint >= 0) {
    most = kMissedAngle;
    for (const auto& side : bodies_->limit_sides(row.joint)) {
      if (side.number != row.side) continue;
      gap = -side.beyond;
      wrench = spatial(-side.axis, Vec3::Zero());
    }
  } else if (row.contact >= 0) {
    most = kMissedGap;
    const Contact& contact = contacts_[at(row.contact)];
    const Vec3 a = bodies_->state(contact.a).to_world * contact.on_a;
    const Vec3 b = contact.b < 0 ? contact.on_b : bodies_->state(contact.b).to_world * contact.on_b;
    gap = contact.normal.dot(a - b);
    wrench = wrench_at(0.5 * (a + b), contact.normal);
  } else {
    return false;
  }
  if (gap >= row.asked - most) return false;
  double speed = wrench.dot(moving_[at(group.a)]);
  if (group.b >= 0) speed -= wrench.dot(moving_[at(group.b)]);
  row.wrench = wrench;
  row.target = speed + (row.asked - gap) / step_;
  if (row.gap > 0) row.kept = row.target;
  return true;
}

}  // namespace krok::ragdoll
