#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "ik/tree_internal.h"

namespace krok::ik {

namespace {

// How near a limit a joint counts as held by it, radians.
constexpr double kAtLimit = 1e-6;

// The directions (in the joint's frame, not unit) in which a joint at its limits cannot turn.
int outward_normals(const ChainJoint& joint, Vec3 normals[2]) {
  if (!joint.limit) return 0;
  const JointLimit& limit = *joint.limit;
  const LimitAngles angles = measure(limit, joint.local);
  int count = 0;
  const bool hinge = joint.is_hinge();
  if (limit.max_twist - limit.min_twist < 2 * kPi) {
    const Vec3 normal = hinge ? limit.axis : gradients(limit, joint.local).twist;
    if (angles.twist > limit.max_twist - kAtLimit) {
      normals[count++] = normal;
    } else if (angles.twist < limit.min_twist + kAtLimit) {
      normals[count++] = -normal;
    }
  }
  if (!hinge) {
    const auto beyond =
        std::array<double, 2>{angles.swing[0] * (1 + kAtLimit), angles.swing[1] * (1 + kAtLimit)};
    if (nearest_swing(limit, beyond) != beyond) {
      normals[count++] = gradients(limit, joint.local).swing;
    }
  }
  return count;
}

// By how much the goal's square error would fall for each radian that the joint's limit gave way.
double gain_of(const Tree& tree, const GoalRows& g, int j, const std::vector<double>& errors,
               std::vector<double>& scratch) {
  const ChainJoint& joint = tree.joints[at(j)];
  Vec3 normals[2];
  const int count = outward_normals(joint, normals);
  double best = 0;
  for (int i = 0; i < count; ++i) {
    const double length = normals[i].norm();
    if (!(length > 1e-9)) continue;
    Freedom freedom;
    freedom.joint = j;
    freedom.world = joint.world.orientation * (normals[i] / length);
    std::fill(scratch.begin(), scratch.end(), 0.0);
    tree.column(g, freedom, scratch.data());
    double gain = 0;
    for (int r = g.row; r < g.row + g.rows; ++r) gain += scratch[at(r)] * errors[at(r)];
    best = std::max(best, gain);
  }
  return best;
}

}  // namespace

void find_holding_joints(Tree& tree, std::span<Residual> residuals) {
  std::vector<double> errors(at(tree.rows), 0.0), scratch(at(tree.rows), 0.0);
  tree.errors(errors);
  for (std::size_t i = 0; i < tree.goals.size(); ++i) {
    if (residuals[i].reached) continue;
    const GoalRows& g = tree.goals[i];
    double square = 0;
    for (int r = g.row; r < g.row + g.rows; ++r) square += errors[at(r)] * errors[at(r)];
    // Less than a thousandth of the error for each radian is no help.
    double best = 1e-3 * square;
    for (int k = 0; k < g.moving; ++k) {
      const int j = tree.path[at(g.first_path + k)];
      if (!tree.joints[at(j)].moves) continue;
      const double gain = gain_of(tree, g, j, errors, scratch);
      if (gain > best) {
        best = gain;
        residuals[i].held_by = tree.joints[at(j)].index;
      }
    }
  }
}

}  // namespace krok::ik
