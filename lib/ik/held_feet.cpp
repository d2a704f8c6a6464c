#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ik/frame_solver_internal.h"
#include "ik/two_bone.h"
#include "math/quaternion.h"

namespace krok::ik {

namespace {

// The axis about which a knee bends to a distance: the captured one, which gives way to the usual
// one as flexion is added to a leg that is nearly straight, or bent backwards. Not as in lib/plant
// (part_given_way() in foot_paths.cpp), where a quarter of the captured flexion is enough and the
// result is smoothed over time: here a frame is solved by itself and hips may sink by any way, so
// that the plane must not turn faster than the knee bends.
Vec3 knee_axis(const TwoBoneChain& chain, const Vec3& target, const Vec3& usual_axis) {
  constexpr double kStraight = 0.1, kBent = 0.7;  // radians
  const Vec3 thigh = chain.middle - chain.root, shank = chain.end - chain.middle;
  const Vec3 line = (chain.end - chain.root).stableNormalized();
  const Vec3 usual = (usual_axis - line * line.dot(usual_axis)).stableNormalized();
  const Vec3 hinge = thigh.cross(shank);
  if (hinge.norm() < 1e-5 * thigh.norm() * shank.norm()) return usual;
  const double angle = std::atan2(line.dot(usual.cross(hinge)), usual.dot(hinge));
  const auto bend_at = [&](const Vec3& end) {
    return two_bone_bend(thigh.norm(), shank.norm(), (end - chain.root).norm());
  };
  const double bend = bend_at(chain.end), added = std::max(0.0, bend_at(target) - bend);
  const double u = std::min(1.0, added / std::max(bend, kStraight));
  double part = u * u * (3 - 2 * u);
  if (std::abs(angle) < kPi / 2) part *= std::max(0.0, 1 - bend / kBent);
  return from_rotation_vector((1 - part) * angle * line) * usual;
}

}  // namespace

// Adds goals for what others would take along.
void FrameSolver::hold() {
  const auto& parents = clip_.skeleton.parents;
  held_.clear();
  for (const HeldFoot& leg : options_.held) {
    const int joint = leg.foot;
    int carrier = joint;
    while (carrier >= 0 && in_chain_[at(carrier)] == 0) carrier = parents[at(carrier)];
    if (carrier < 0 && !solver_.options().root_moves) continue;
    Goal goal;
    goal.kind = Goal::Kind::pose;
    goal.joint = joint;
    goal.target = given_[at(joint)].position;
    goal.orientation = given_[at(joint)].orientation;
    goal.weight = kHeldWeight;
    active_.push_back(goal);
    held_.push_back(&leg);
  }
  mark_chains();
}

// Legs from where the hips are now to where the feet were. The solver only sees to it that they
// reach: it would as soon bend a knee backwards.
void FrameSolver::bend_legs() {
  const auto& parents = clip_.skeleton.parents;
  for (const HeldFoot* leg : held_) {
    if (leg->upper < 0) continue;
    const int above = parents[at(leg->upper)];
    const Transform moved =
        above < 0 ? Transform() : solved_[at(above)] * given_[at(above)].inverse();
    const auto carried = [&](int joint) { return moved * given_[at(joint)]; };
    const Transform upper = carried(leg->upper), lower = carried(leg->lower);
    TwoBoneChain chain{upper.position, lower.position, carried(leg->foot).position, Vec3::Zero()};
    TwoBoneGoal goal;
    goal.target = given_[at(leg->foot)].position;
    chain.hinge = knee_axis(chain, goal.target, upper.orientation * leg->knee_axis);
    const Vec3 line = chain.end - chain.root, wanted = goal.target - chain.root;
    goal.pole = wanted.cross(shortest_arc(line, wanted) * chain.hinge);
    const TwoBoneSolution solution = solve_two_bone(chain, goal);
    turn_to(leg->upper, solution.root_rotation * upper.orientation);
    turn_to(leg->lower, solution.middle_rotation * lower.orientation);
    turn_to(leg->foot, given_[at(leg->foot)].orientation);
  }
}

// Turns a joint to an orientation in the world, with all that hangs on it.
void FrameSolver::turn_to(int joint, const Quat& orientation) {
  const auto& parents = clip_.skeleton.parents;
  local_.resize(solved_.size());
  world_to_local(parents, solved_, local_);
  const int parent = parents[at(joint)];
  const Quat above = parent < 0 ? Quat::Identity() : solved_[at(parent)].orientation;
  local_[at(joint)].orientation = (above.conjugate() * orientation).normalized();
  local_to_world(parents, local_, solved_);
}

}  // namespace krok::ik
