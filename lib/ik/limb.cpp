#include <cmath>

#include "core/index.h"
#include "ik/tree_internal.h"
#include "ik/two_bone.h"
#include "math/quaternion.h"

namespace krok::ik {

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
