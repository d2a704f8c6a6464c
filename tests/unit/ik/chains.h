#pragma once

#include <random>
#include <vector>

#include "core/index.h"
#include "ik/solver.h"
#include "math/quaternion.h"
#include "scene/skeleton.h"

// Chains, limits and rotations at random for tests of lib/ik.

namespace krok::ik::test {

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }
  Vec3 vector(double size = 1) {
    return {between(-size, size), between(-size, size), between(-size, size)};
  }
  Vec3 direction() {
    Vec3 v = vector();
    while (v.norm() < 0.1) v = vector();
    return v.normalized();
  }
  Quat rotation(double largest = kPi) {
    return from_rotation_vector(between(0, largest) * direction());
  }
  JointLimit cone() {
    JointLimit limit;
    limit.kind = JointLimit::Kind::cone;
    limit.zero = rotation();
    limit.axis = direction();
    limit.swing_axis = limit.axis.unitOrthogonal();
    for (std::size_t i = 0; i < 2; ++i) {
      limit.min_swing[i] = -between(0.05, 2);
      limit.max_swing[i] = between(0.05, 2);
    }
    limit.min_twist = -between(0, 2);
    limit.max_twist = between(0, 2);
    return limit;
  }
  JointLimit hinge() {
    JointLimit limit;
    limit.kind = JointLimit::Kind::hinge;
    limit.zero = rotation();
    limit.axis = direction();
    limit.swing_axis = limit.axis.unitOrthogonal();
    limit.min_twist = between(-3, 1);
    limit.max_twist = limit.min_twist + between(0.1, 3);
    return limit;
  }

 private:
  std::mt19937_64 random_;
};

// A chain along +Y of `joints` joints, each 0.3 m from the one before.
struct Chain {
  std::vector<int> parents;
  std::vector<Transform> pose;  // joint_to_world
};

inline Chain straight_chain(int joints) {
  Chain chain;
  for (int j = 0; j < joints; ++j) {
    chain.parents.push_back(j - 1);
    chain.pose.push_back({Vec3(0, 0.3 * j, 0), Quat::Identity()});
  }
  return chain;
}

inline Chain bent_chain(int joints, Dice& dice, double bend = 0.5) {
  Chain chain = straight_chain(joints);
  std::vector<Transform> local(chain.pose.size());
  world_to_local(chain.parents, chain.pose, local);
  for (Transform& one : local) one.orientation = dice.rotation(bend);
  local_to_world(chain.parents, local, chain.pose);
  return chain;
}

inline Quat local_of(const Chain& chain, int joint) {
  const int parent = chain.parents[at(joint)];
  if (parent < 0) return chain.pose[at(joint)].orientation;
  return chain.pose[at(parent)].orientation.conjugate() * chain.pose[at(joint)].orientation;
}

inline Goal reach(int joint, const Vec3& target) {
  Goal goal;
  goal.joint = joint;
  goal.target = target;
  return goal;
}

inline Solver solver_for(const Chain& chain, Limits limits = {}, Options options = {}) {
  auto solver = Solver::create(chain.parents, std::move(limits), std::move(options));
  return std::move(*solver);
}

}  // namespace krok::ik::test
