#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ik/tree_internal.h"
#include "math/quaternion.h"

namespace krok::ik {

namespace {

constexpr double kShortest = 1e-9;

// The rotation vector that takes one orientation to another.
Vec3 rotation_between(const Quat& from, const Quat& to) {
  return rotation_vector(to * from.conjugate());
}

// The bend of a limb seen along the line from its upper to its lower joint: the angle about that
// line from the middle joint to the pole target, and the derivatives of the angle by the three
// points (Blondel and Karplus, "New formulation for derivatives of torsion angles", 1996).
struct Pole {
  bool defined = false;
  double angle = 0;
  Vec3 by_upper = Vec3::Zero(), by_middle = Vec3::Zero(), by_lower = Vec3::Zero();
};

Pole pole_of(const Vec3& target, const Vec3& upper, const Vec3& lower, const Vec3& middle) {
  // The torsion of target - upper - lower - middle. f, g and h are the usual names.
  const Vec3 f = target - upper, g = upper - lower, h = middle - lower;
  const Vec3 a = f.cross(g), b = h.cross(g);
  const double length = g.norm();
  Pole pole;
  // The sines of the angles that target and middle make with the line.
  if (!(length > kShortest) || !(a.norm() > 1e-4 * length * f.norm()) ||
      !(b.norm() > 1e-4 * length * h.norm())) {
    return pole;
  }
  pole.defined = true;
  pole.angle = std::atan2(b.cross(a).dot(g) / length, a.dot(b));
  const Vec3 a_part = a / a.squaredNorm(), b_part = b / b.squaredNorm();
  const Vec3 across = (f.dot(g) / length) * a_part - (h.dot(g) / length) * b_part;
  pole.by_upper = length * a_part + across;
  pole.by_lower = -across - length * b_part;
  pole.by_middle = length * b_part;
  return pole;
}

Vec3 line_of_sight(const Transform& joint, const Goal& goal, const Vec3& target) {
  const Vec3 line = target - joint * goal.point;
  const double length = line.norm();
  return length > kShortest ? Vec3(line / length) : Vec3(joint.orientation * goal.axis);
}

void put(double* to, const Vec3& value) {
  to[0] = value.x();
  to[1] = value.y();
  to[2] = value.z();
}

Vec2 nearest_on_segment(const Vec2& a, const Vec2& b, const Vec2& point) {
  const Vec2 along = b - a;
  const double square = along.squaredNorm();
  const double t = square > 0 ? std::clamp((point - a).dot(along) / square, 0.0, 1.0) : 0.0;
  return a + t * along;
}

double cross_of(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

Vec2 to_support(std::span<const Vec2> support, const Vec2& point) {
  if (support.empty()) return Vec2::Zero();
  bool left = support.size() > 2, right = support.size() > 2;
  Vec2 best = support[0] - point;
  for (std::size_t i = 0; i < support.size(); ++i) {
    const Vec2& a = support[i];
    const Vec2& b = support[(i + 1) % support.size()];
    const double side = cross_of(b - a, point - a);
    left = left && side >= 0;
    right = right && side <= 0;
    const Vec2 way = nearest_on_segment(a, b, point) - point;
    if (way.squaredNorm() < best.squaredNorm()) best = way;
  }
  return left || right ? Vec2(Vec2::Zero()) : best;
}

double Tree::errors(std::span<double> rows_of) const {
  double* const to = rows_of.data();
  for (const GoalRows& g : goals) {
    const Goal& goal = *g.goal;
    double* const out = to + g.row;
    if (goal.kind == Goal::Kind::balance) {
      const ChainJoint& root = joints.front();
      Vec2 way = Vec2::Zero();
      if (root.mass > 0) {
        const Vec3 centre = root.moment / root.mass;
        way = to_support(goal.support, {centre.x(), centre.z()});
      }
      out[0] = goal.weight * way.x();
      out[1] = goal.weight * way.y();
      continue;
    }
    const Transform& joint = joints[at(g.effector)].world;
    const Vec3 target = target_of(g);
    switch (goal.kind) {
      case Goal::Kind::pose:
        put(out + 3, goal.weight * rotation_between(joint.orientation, orientation_of(g)));
        [[fallthrough]];
      case Goal::Kind::position:
        put(out, goal.weight * (target - joint * goal.point));
        break;
      case Goal::Kind::orientation:
        put(out, goal.weight * rotation_between(joint.orientation, orientation_of(g)));
        break;
      case Goal::Kind::look_at:
        put(out, goal.weight * rotation_vector(shortest_arc(joint.orientation * goal.axis,
                                                            line_of_sight(joint, goal, target))));
        break;
      default: {
        const Pole pole = pole_of(target, joints[at(g.upper)].world.position,
                                  joints[at(g.lower)].world.position, joint.position);
        out[0] = pole.defined ? -goal.weight * pole.angle : 0;
        break;
      }
    }
  }
  double sum = 0;
  for (int r = 0; r < rows; ++r) sum += to[r] * to[r];
  return sum;
}

void Tree::column(const GoalRows& g, const Freedom& freedom, double* column) const {
  const Goal& goal = *g.goal;
  double* const out = column + g.row;
  const Vec3& axis = freedom.world;
  const ChainJoint& turning = joints[at(freedom.joint)];
  // How a point moves that hangs on the joint, or on one that it may not carry.
  const auto moved = [&](const Vec3& point) {
    return freedom.shift ? axis : Vec3(axis.cross(point - turning.world.position));
  };
  const auto moved_with = [&](int carried, const Vec3& point) {
    return carries(freedom.joint, carried) ? moved(point) : Vec3(Vec3::Zero());
  };
  const auto turned_with = [&](int carried) {
    return !freedom.shift && carries(freedom.joint, carried) ? axis : Vec3(Vec3::Zero());
  };
  if (goal.kind == Goal::Kind::balance) {
    const double total = joints.front().mass;
    if (!(total > 0) || !(turning.mass > 0)) return;
    const Vec3 way = (turning.mass / total) * moved(turning.moment / turning.mass);
    out[0] = goal.weight * way.x();
    out[1] = goal.weight * way.z();
    return;
  }
  const Transform& joint = joints[at(g.effector)].world;
  const Vec3 target = target_of(g);
  switch (goal.kind) {
    case Goal::Kind::pose:
      put(out + 3, goal.weight * Vec3(turned_with(g.effector) - turned_with(g.anchor)));
      [[fallthrough]];
    case Goal::Kind::position:
      put(out, goal.weight *
                   Vec3(moved_with(g.effector, joint * goal.point) - moved_with(g.anchor, target)));
      break;
    case Goal::Kind::orientation:
      put(out, goal.weight * Vec3(turned_with(g.effector) - turned_with(g.anchor)));
      break;
    case Goal::Kind::look_at: {
      // The axis turns by what of the rotation is across it; the line of sight turns back as the
      // eye moves sideways.
      const Vec3 eye = joint * goal.point;
      const Vec3 facing = joint.orientation * goal.axis;
      const Vec3 line = line_of_sight(joint, goal, target);
      const Vec3 turned = turned_with(g.effector);
      const Vec3 way = moved_with(g.effector, eye) - moved_with(g.anchor, target);
      const double distance = std::max(kShortest, (target - eye).norm());
      put(out,
          goal.weight * Vec3(turned - facing * facing.dot(turned) + line.cross(way) / distance));
      break;
    }
    default: {
      const Vec3 &upper = joints[at(g.upper)].world.position,
                 &lower = joints[at(g.lower)].world.position;
      const Pole pole = pole_of(target, upper, lower, joint.position);
      if (!pole.defined) break;
      // The angle stays as all points move alike, so that these are the derivatives by the target.
      const Vec3 by_target = -(pole.by_upper + pole.by_middle + pole.by_lower);
      out[0] = goal.weight * (pole.by_lower.dot(moved_with(g.lower, lower)) +
                              pole.by_middle.dot(moved_with(g.effector, joint.position)) +
                              pole.by_upper.dot(moved_with(g.upper, upper)) +
                              by_target.dot(moved_with(g.anchor, target)));
      break;
    }
  }
}

Residual Tree::residual(const GoalRows& g, const Options& options) const {
  const Goal& goal = *g.goal;
  Residual residual;
  if (goal.kind == Goal::Kind::balance) {
    const ChainJoint& root = joints.front();
    if (root.mass > 0) {
      const Vec3 centre = root.moment / root.mass;
      residual.distance = to_support(goal.support, {centre.x(), centre.z()}).norm();
    }
  } else {
    const Transform& joint = joints[at(g.effector)].world;
    const Vec3 target = target_of(g);
    if (goal.kind == Goal::Kind::position || goal.kind == Goal::Kind::pose) {
      residual.distance = (target - joint * goal.point).norm();
    }
    if (goal.kind == Goal::Kind::orientation || goal.kind == Goal::Kind::pose) {
      residual.angle = angle_between(joint.orientation, orientation_of(g));
    }
    if (goal.kind == Goal::Kind::look_at) {
      const Vec3 facing = joint.orientation * goal.axis;
      const Vec3 line = line_of_sight(joint, goal, target);
      residual.angle = std::atan2(facing.cross(line).norm(), facing.dot(line));
    }
    if (goal.kind == Goal::Kind::pole) {
      const Pole pole = pole_of(target, joints[at(g.upper)].world.position,
                                joints[at(g.lower)].world.position, joint.position);
      residual.angle = pole.defined ? std::abs(pole.angle) : 0;
    }
  }
  residual.reached = residual.distance <= options.distance && residual.angle <= options.angle;
  return residual;
}

bool Tree::reached(std::span<const double> errors_of, const Options& options) const {
  for (const GoalRows& g : goals) {
    const double* const e = errors_of.data() + g.row;
    const auto norm = [&](int first, int count) {
      double sum = 0;
      for (int i = first; i < first + count; ++i) sum += e[i] * e[i];
      return std::sqrt(sum) / g.goal->weight;
    };
    double distance = 0, angle = 0;
    switch (g.goal->kind) {
      case Goal::Kind::position:
      case Goal::Kind::balance:
        distance = norm(0, g.rows);
        break;
      case Goal::Kind::pose:
        distance = norm(0, 3);
        angle = norm(3, 3);
        break;
      default:
        angle = norm(0, g.rows);
        break;
    }
    // A little less than residual() allows, which may round differently.
    if (!(distance <= options.distance * (1 - 1e-9)) || !(angle <= options.angle * (1 - 1e-9))) {
      return false;
    }
  }
  return true;
}

}  // namespace krok::ik
