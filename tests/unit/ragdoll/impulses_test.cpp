// If this fails, contacts and limits push bodies as if others were lighter or heavier than they
// are.

#include <gtest/gtest.h>

#include <array>

#include "ragdoll/articulation_internal.h"

namespace krok::ragdoll {
namespace {

// The speed along one wrench by another: from the freedoms up to the roots, and from all twists.
TEST(RagdollImpulses, FreedomsAddUpToTheAnswerOfTheTree) {
  std::vector<BodyState> states(5);  // the first four in a chain
  for (int b = 0; b < 5; ++b) states[at(b)].to_world.position = Vec3(0.3 * b, 0.1 * b, 1);
  std::vector<Joint> joints(3);
  for (int j = 0; j < 3; ++j) {
    joints[at(j)].parent = j;
    joints[at(j)].child = j + 1;
    joints[at(j)].in_parent.position = Vec3(0.15, 0.05, 0);
    joints[at(j)].in_child.position = Vec3(-0.15, -0.05, 0);
  }
  joints[1].kind = JointKind::revolute;
  joints[2].kind = JointKind::six_dof;
  joints[2].slide = {Range{-1, 1}, Range{0, 0}, Range{0, 0}};
  Articulation tree;
  ASSERT_TRUE(tree.build(std::vector<Body>(5), states, joints).ok());
  tree.accelerate(1.0 / 240, Vec3::Zero());
  Vec6 first, second;
  first << 0.2, -0.7, 0.4, 1, 0.5, -0.3;
  second << -0.1, 0.3, 0.9, -0.4, 1, 0.6;
  for (const auto& [a, b, c, d] : {std::array{3, -1, 0, -1}, std::array{3, 2, 3, 1},
                                   std::array{1, 3, 2, 4}, std::array{4, -1, 2, -1}}) {
    std::vector<Vec6> wrenches(5, Vec6::Zero()), twists = wrenches;
    wrenches[at(c)] = second;
    if (d >= 0) wrenches[at(d)] = -second;
    tree.answer(wrenches, twists);
    const double whole = first.dot(twists[at(a)] - (b < 0 ? Vec6(Vec6::Zero()) : twists[at(b)]));
    Eigen::VectorXd given = Eigen::VectorXd::Zero(tree.freedom_count());
    tree.each_answer(a, b, first, [&](int number, const auto& impulse, const auto&) {
      given.segment(number, impulse.size()) = impulse;
    });
    double sum = 0;
    tree.each_answer(c, d, second, [&](int number, const auto&, const auto& speed) {
      sum += given.segment(number, speed.size()).dot(speed);
    });
    EXPECT_NEAR(sum, whole, 1e-9) << a << b << c << d;
  }
}

}  // namespace
}  // namespace krok::ragdoll
