// If these fail, examples of a library do not fit it or each other.

#include "parametric/library.h"

#include <gmock/gmock.h>

#include <cmath>

#include "motion/travel.h"
#include "walks.h"

namespace krok::parametric {
namespace {

using testing::HasSubstr;

const test::KeyedWalk& plain_walk() {
  static const test::KeyedWalk made = test::keyed_walk({});
  return made;
}

Library frame() {
  std::vector<test::KeyedWalk> walks = {plain_walk()};
  Library library = test::library_of(walks, {"step.length", "Head.up@swing_off"}).library;
  library.examples.clear();
  return library;
}

TEST(Library, AnExampleIsSetOnItsStanceFoot) {
  const Library library = frame();
  Clip clip = plain_walk().walk.clip;
  const double strike = plain_walk().keys.keytimes[0].time;
  const std::vector<double> times = {strike, strike + 0.15, strike + 0.5};
  const auto wanted = make_example(library, "a", clip, times);
  ASSERT_TRUE(wanted.ok()) << wanted.error().message;
  // Wherever the motion was.
  move_clip({Vec3(4, -1, 7), axis_rotation(Axis::y, 2.2)}, clip);
  const auto found = make_example(library, "a", clip, times);
  ASSERT_TRUE(found.ok());
  for (std::size_t i = 0; i < clip.positions.size(); ++i) {
    EXPECT_LT((found->motion.positions[i] - wanted->motion.positions[i]).norm(), 1e-5f);
  }
  EXPECT_NEAR(found->parameters[0], wanted->parameters[0], 1e-5);
  EXPECT_NEAR(found->parameters[1], wanted->parameters[1], 1e-5);
  EXPECT_GT(found->parameters[1], 1.3);
}

TEST(Library, ExamplesMustFit) {
  const Library library = frame();
  const Clip& clip = plain_walk().walk.clip;
  const auto code = [&](const Clip& motion, std::vector<double> times) {
    const auto made = make_example(library, "one", motion, std::move(times));
    if (made.ok()) return std::string();
    EXPECT_THAT(made.error().message, testing::AnyOf(HasSubstr("one"), HasSubstr("skeleton")));
    return made.error().code;
  };
  EXPECT_EQ(code(clip, {0, 0.2, 0.5}), "");
  EXPECT_EQ(code(clip, {0, 0.5}), "parametric-keytimes");
  EXPECT_EQ(code(clip, {}), "parametric-keytimes");
  EXPECT_EQ(code(clip, {0, 0.5, 0.2}), "parametric-keytimes");
  EXPECT_EQ(code(clip, {0, 0.2, 0.205}), "parametric-keytimes");
  EXPECT_EQ(code(clip, {-0.1, 0.2, 0.5}), "parametric-keytimes");
  EXPECT_EQ(code(clip, {0, 0.2, 500}), "parametric-keytimes");
  EXPECT_EQ(code(clip, {0, std::nan(""), 0.5}), "parametric-keytimes");
  Clip other = clip;
  other.skeleton.reference[5].position.y() += 0.1;
  EXPECT_EQ(code(other, {0, 0.2, 0.5}), "parametric-skeleton");
  other = clip;
  other.resize(0);
  EXPECT_EQ(code(other, {0, 0.2, 0.5}), "parametric-keytimes");
}

TEST(Library, IntervalsMayBeTwoFramesOrTenMilliseconds) {
  Library library;
  library.rate = 60;
  EXPECT_NEAR(shortest_interval(library), 0.01, 1e-9);
  library.rate = 1000;
  EXPECT_NEAR(shortest_interval(library), 0.002, 1e-9);
}

// Would fail if what a role map says were forgotten once the library is made: the motions of a
// capture whose root stands would be summed at that root.
TEST(Library, GivenRolesSayWhatCarriesTheMotions) {
  std::vector<test::KeyedWalk> walks = {plain_walk()};
  Library library = test::library_of(walks, {"step.length"}).library;
  EXPECT_TRUE(library.given_roles.empty());
  const int hips = carrying_joint(library);
  const int spine = library.skeleton.find("Spine");
  ASSERT_GT(spine, hips);
  library.given_roles = {{spine, Role::helper, {}}};
  EXPECT_TRUE(check(library));
  EXPECT_EQ(roles_of(library).roles[static_cast<std::size_t>(spine)], Role::helper);
  EXPECT_EQ(carrying_joint(library), hips);
  EXPECT_EQ(given_roles(roles_of(library)).size(), 1u);
  EXPECT_EQ(given_roles(roles_of(library))[0].joint, spine);

  library.given_roles = {{spine, Role::helper, {}}, {spine, Role::none, {}}};
  EXPECT_EQ(check(library).error().code, "parametric-roles");
  library.given_roles = {{library.skeleton.joint_count(), Role::hips, {}}};
  EXPECT_EQ(check(library).error().code, "parametric-roles");
}

TEST(Library, MirroredTwiceIsTheSame) {
  std::vector<test::KeyedWalk> walks = {plain_walk()};
  const Library library = test::library_of(walks, {"step.length", "step.turn"}).library;
  const auto twice = mirrored(*mirrored(library));
  ASSERT_TRUE(twice.ok());
  EXPECT_EQ(twice->swing, library.swing);
  for (std::size_t f = 0; f < 2; ++f) {
    EXPECT_EQ(twice->feet[f].joint, library.feet[f].joint);
    EXPECT_LT((twice->feet[f].heel - library.feet[f].heel).norm(), 1e-12);
  }
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    const Example &found = twice->examples[i], &wanted = library.examples[i];
    EXPECT_EQ(found.mirrored, wanted.mirrored);
    EXPECT_EQ(found.contacts.size(), wanted.contacts.size());
    for (std::size_t k = 0; k < wanted.motion.positions.size(); ++k) {
      EXPECT_LT((found.motion.positions[k] - wanted.motion.positions[k]).norm(), 2e-6f);
    }
  }
  // The hips are on no side.
  Library odd = library;
  odd.feet[0].joint = 0;
  const auto refused = mirrored(odd);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, "parametric-feet");
}

}  // namespace
}  // namespace krok::parametric
