#include <algorithm>

#include "core/index.h"
#include "ik/tree_internal.h"
#include "ik/two_bone.h"
#include "math/quaternion.h"

namespace krok::ik {

namespace {

// The turn of a joint that brings one goal nearest, as a rotation vector in the world; false where
// the goal asks nothing of this joint.
bool wanted_turn(const Tree& tree, const GoalRows& g, int j, Vec3& turn) {
  const Goal& goal = *g.goal;
  // A joint that carries the target, too, changes nothing.
  if (g.effector < 0 || tree.carries(j, g.anchor)) return false;
  const Vec3 target = tree.target_of(g);
  const Quat orientation = tree.orientation_of(g);
  const Transform& effector = tree.joints[at(g.effector)].world;
  const Vec3& origin = tree.joints[at(j)].world.position;
  const bool own = j == g.effector;
  switch (goal.kind) {
    case Goal::Kind::position:
      turn = rotation_vector(shortest_arc(effector * goal.point - origin, target - origin));
      return true;
    case Goal::Kind::orientation:
      turn = rotation_vector(orientation * effector.orientation.conjugate());
      return true;
    case Goal::Kind::pose:
      // The effector's own joint gives the orientation, those above it the position.
      turn = own ? rotation_vector(orientation * effector.orientation.conjugate())
                 : rotation_vector(shortest_arc(effector * goal.point - origin, target - origin));
      return true;
    case Goal::Kind::look_at:
      turn = rotation_vector(
          shortest_arc(effector.orientation * goal.axis, target - effector * goal.point));
      return true;
    default:
      return false;
  }
}

// The mean of what all goals within whose depth the joint lies want of it; false for none.
bool mean_turn(const Tree& tree, int j, Vec3& mean) {
  double weights = 0;
  mean = Vec3::Zero();
  for (const GoalRows& g : tree.goals) {
    const auto begin = tree.path.begin() + g.first_path;
    if (std::find(begin, begin + g.moving, j) == begin + g.moving) continue;
    Vec3 turn;
    if (!wanted_turn(tree, g, j, turn)) continue;
    mean += g.goal->weight * turn;
    weights += g.goal->weight;
  }
  if (!(weights > 0)) return false;
  mean /= weights;
  return true;
}

}  // namespace

int solve_ccd(Tree& tree, const Options& options) {
  std::vector<double> errors(at(tree.rows));
  int sweep = 0;
  while (sweep < options.iterations) {
    tree.errors(errors);
    if (tree.reached(errors, options)) break;
    ++sweep;
    double moved = 0;
    for (int j = static_cast<int>(tree.joints.size()) - 1; j >= 0; --j) {
      ChainJoint& joint = tree.joints[at(j)];
      Vec3 turn;
      if (!joint.moves || !mean_turn(tree, j, turn)) continue;
      const Quat before = joint.local;
      Vec3 local = joint.weight * (joint.world.orientation.conjugate() * turn);
      if (joint.is_hinge()) {
        joint.set_twist(joint.twist + joint.limit->axis.dot(local));
      } else {
        joint.set_local((joint.local * from_rotation_vector(local)).normalized());
      }
      moved = std::max(moved, angle_between(before, joint.local));
      tree.forward(j);
    }
    // Nothing turns any more: as near as it gets.
    if (moved < 1e-9) break;
  }
  return sweep;
}

namespace {

// Turns a joint in the world, within its limits.
void turn_joint(Tree& tree, int j, const Quat& world_turn) {
  ChainJoint& joint = tree.joints[at(j)];
  if (!joint.moves) return;
  const Quat& orientation = joint.world.orientation;
  const Quat turn = orientation.conjugate() * world_turn * orientation;
  joint.set_local((joint.local * turn).normalized());
  tree.forward(j);
}

// The hinge of the limb's middle joint in the world, where its limit knows it.
Vec3 hinge_of(const ChainJoint& middle) {
  return middle.is_hinge() ? Vec3(middle.world.orientation * middle.limit->axis)
                           : Vec3(Vec3::Zero());
}

Vec3 pole_for(const Tree& tree, int middle, const Vec3& root) {
  for (const GoalRows& g : tree.goals) {
    if (g.goal->kind == Goal::Kind::pole && g.effector == middle) return tree.target_of(g) - root;
  }
  return Vec3::Zero();
}

// Without a pole the plane of the bend swings along with the limb, by the shortest way.
void keep_plane(TwoBoneChain& chain, TwoBoneGoal& goal) {
  const Vec3 upper = chain.middle - chain.root, lower = chain.end - chain.middle;
  const Vec3 hinge = upper.cross(lower), line = chain.end - chain.root;
  const bool bends = hinge.norm() > 1e-6 * upper.norm() * lower.norm();
  if (chain.hinge.isZero() && bends) chain.hinge = hinge;
  if (!goal.pole.isZero() || chain.hinge.isZero()) return;
  goal.pole = shortest_arc(line, goal.target - chain.root) * line.cross(chain.hinge);
}

}  // namespace

void solve_limbs(Tree& tree, const Options& options) {
  (void)options;
  for (const GoalRows& g : tree.goals) {
    const Goal& goal = *g.goal;
    const bool pose = goal.kind == Goal::Kind::pose;
    if (!pose && goal.kind != Goal::Kind::position) continue;
    const int end = g.effector;
    const int middle = tree.joints[at(end)].parent;
    const int root = middle < 0 ? -1 : tree.joints[at(middle)].parent;
    if (root < 0) continue;
    const Transform& effector = tree.joints[at(end)].world;
    const Quat orientation = tree.orientation_of(g);
    // The end joint's own turn comes first, so that its point hangs on it as it will in the end.
    const Quat turned = pose ? orientation : effector.orientation;
    TwoBoneChain chain;
    chain.root = tree.joints[at(root)].world.position;
    chain.middle = tree.joints[at(middle)].world.position;
    chain.end = effector.position;
    chain.hinge = hinge_of(tree.joints[at(middle)]);
    TwoBoneGoal two;
    two.target = tree.target_of(g) - turned * goal.point;
    two.pole = pole_for(tree, middle, chain.root);
    keep_plane(chain, two);
    const TwoBoneSolution solution = solve_two_bone(chain, two);
    const Quat keeps = effector.orientation;
    turn_joint(tree, root, solution.root_rotation);
    // The solution's second rotation is of the middle joint as it was; the root's turn moved it.
    turn_joint(tree, middle, solution.middle_rotation * solution.root_rotation.conjugate());
    const Quat now = tree.joints[at(end)].world.orientation;
    turn_joint(tree, end, (pose ? orientation : keeps) * now.conjugate());
  }
}

}  // namespace krok::ik
