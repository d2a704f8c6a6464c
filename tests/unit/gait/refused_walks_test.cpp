// Footprints that no one can walk along are refused, with the number of the print. If these fail,
// krok-walk makes a motion that looks broken and exits with 0.

#include <gtest/gtest.h>

#include "core/index.h"
#include "motion/local_motion.h"
#include "terrain/shapes.h"
#include "unit/gait/walkers.h"

namespace krok::gait {
namespace {

using test::Ground;
using test::prints_of;
using test::walking;

const Ground kLevel([](double, double) { return 0.0; });

struct Refused {
  std::string name, code;
  std::function<void(std::vector<Print>&)> spoil;
  std::function<double(double, double)> height;
  int number = 0;  // of the print in the message; 0: none
};

class RefusedWalk : public testing::TestWithParam<Refused> {};

INSTANTIATE_TEST_SUITE_P(
    Prints, RefusedWalk,
    testing::Values(
        Refused{"TooFew", "walk-prints", [](auto& prints) { prints.resize(2); }, {}},
        Refused{"SameSideTwice",
                "walk-prints",
                [](auto& prints) { prints[3].side = prints[2].side; },
                {},
                4},
        Refused{"NotANumber", "walk-prints", [](auto& prints) { prints[2].x = NAN; }, {}, 3},
        Refused{"BeyondTheWorld", "walk-prints", [](auto& prints) { prints[2].z = 1e300; }, {}, 3},
        Refused{"TooLong", "walk-too-long", [](auto& prints) { prints[4].z += 1.2; }, {}, 5},
        Refused{"TooHigh", "walk-too-high", [](auto&) {},
                [](double, double z) { return z > 1.3 ? 0.7 : 0.0; }, 0},
        Refused{"IntoAPit", "walk-too-high", [](auto&) {},
                [](double, double z) { return z > 1.3 ? -0.9 : 0.0; }, 0},
        Refused{"TooSteep", "walk-too-steep", [](auto&) {},
                [](double, double z) { return z > 1 ? z - 1 : 0.0; }, 0},
        Refused{"AcrossAnEdge", "walk-too-steep", [](auto& prints) { prints[4].z = 1.9; },
                [](double, double z) { return z > 2 ? 0.3 : 0.0; }, 5},
        Refused{"Hole", "walk-ground", [](auto&) {},
                [](double, double z) { return z > 1.3 && z < 1.7 ? NAN : 0.0; }, 0},
        Refused{"Crossing", "walk-crossing", [](auto& prints) { prints[4].x -= 0.5; }, {}, 5},
        Refused{"OnTheOtherFoot",
                "walk-crossing",
                [](auto& prints) {
                  prints[4].x = prints[3].x;
                  prints[4].z = prints[3].z + 0.05;
                },
                {},
                5},
        Refused{"FootTurnedBack",
                "walk-heading",
                [](auto& prints) { prints[4].heading += kPi; },
                {},
                5},
        Refused{"BackInTime",
                "walk-time",
                [](auto& prints) {
                  prints[3].time = 2;
                  prints[4].time = 1;
                },
                {},
                5},
        Refused{"AtOnce",
                "walk-time",
                [](auto& prints) {
                  prints[3].time = 2;
                  prints[4].time = 2.05;
                },
                {},
                5}),
    [](const auto& given) { return given.param.name; });

TEST_P(RefusedWalk, NamesThePrintAndTheReason) {
  std::vector<Print> prints = prints_of({.steps = 6});
  GetParam().spoil(prints);
  const Ground ground(GetParam().height ? GetParam().height : [](double, double) { return 0.0; });
  const auto made = walk(walking(), prints, ground, {});
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, GetParam().code) << made.error().message;
  if (GetParam().number > 0) {
    const std::string number = "print " + std::to_string(GetParam().number) + ":";
    EXPECT_NE(made.error().message.find(number), std::string::npos) << made.error().message;
  }
}

// A thin wall that reaches to the floor, where the floor goes on below it.
TEST(WalkIntoAWall, IsRefused) {
  const auto quad = [](Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    return std::vector<terrain::GroundTriangle>{{a, b, c}, {a, c, d}};
  };
  std::vector<terrain::GroundTriangle> mesh = quad({-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9});
  for (const double z : {1.6, 1.602}) {
    for (const auto& triangle : quad({-3, 0, z}, {3, 0, z}, {3, 2.5, z}, {-3, 2.5, z})) {
      mesh.push_back(triangle);
    }
  }
  const auto ground = terrain::mesh_ground(mesh);
  ASSERT_TRUE(ground.ok());
  const auto made = walk(walking(), prints_of({.steps = 6}), **ground, {});
  ASSERT_FALSE(made.ok());
  EXPECT_EQ(made.error().code, "walk-wall") << made.error().message;
  // Beside it there is a way.
  std::vector<Print> beside = prints_of({.steps = 6});
  for (Print& print : beside) print.x += 4;
  EXPECT_TRUE(walk(walking(), beside, **ground, {}).ok());
}

// What is too far is moved as far as the walker can reach, and said.
TEST(AdaptedWalk, TakesTheNearestPrintThatCanBeReached) {
  std::vector<Print> prints = prints_of({.steps = 6});
  for (std::size_t k = 5; k < prints.size(); ++k) prints[k].z += 0.8;
  ASSERT_FALSE(walk(walking(), prints, kLevel, {}).ok());
  const auto made = walk(walking(), prints, kLevel, {.adapt = true});
  ASSERT_TRUE(made.ok()) << made.error().message;
  double moved = 0;
  int count = 0;
  for (const StepReport& step : made->details.steps) {
    if (step.moved == 0) continue;
    ++count;
    EXPECT_FALSE(step.why_moved.empty());
    moved = std::max(moved, step.moved);
  }
  EXPECT_GE(count, 1);
  EXPECT_GT(moved, 0.1);
  EXPECT_LT(moved, 0.8);
}

// Times of prints are kept; others follow at the library's pace.
TEST(TimedWalk, StrikesWhenAsked) {
  std::vector<Print> prints = prints_of({.steps = 6});
  prints[2].time = 1.5;
  prints[4].time = 2.9;
  const auto made = walk(walking(), prints, kLevel, {});
  ASSERT_TRUE(made.ok()) << made.error().message;
  EXPECT_NEAR(made->details.prints[2].strike, 1.5, 1e-9);
  EXPECT_NEAR(made->details.prints[4].strike, 2.9, 1e-9);
}

TEST(FasterWalk, TakesLessTime) {
  const auto prints = prints_of({.steps = 6});
  const auto usual = walk(walking(), prints, kLevel, {});
  const auto fast = walk(walking(), prints, kLevel, {.speed = 2});
  ASSERT_TRUE(usual.ok() && fast.ok());
  EXPECT_NEAR(fast->details.prints[5].strike, usual->details.prints[5].strike / 2, 1e-6);
  EXPECT_EQ(walk(walking(), prints, kLevel, {.speed = 0}).error().code, "walk-time");
}

// Would fail if the walker stood on knees bent as in the middle of a step. A person's are at 0 to 5
// degrees; 14 is what a leg of 0.994 of its length has.
TEST(Walker, StandsUprightAtBothEnds) {
  const auto walked = walk(walking(), prints_of({}), kLevel, {});
  ASSERT_TRUE(walked.ok()) << walked.error().message;
  const Clip& clip = walked->clip;
  const RoleMap roles = find_roles(clip.skeleton);
  constexpr Role kLegs[][3] = {{Role::left_upper_leg, Role::left_lower_leg, Role::left_foot},
                               {Role::right_upper_leg, Role::right_lower_leg, Role::right_foot}};
  for (const int frame : {0, clip.frame_count() - 1}) {
    for (const auto& leg : kLegs) {
      const auto at = [&](Role role) {
        const auto joint = static_cast<std::size_t>(roles.joint(role));
        return clip.frame_positions(frame)[joint];
      };
      const Vec3f thigh = at(leg[1]) - at(leg[0]), shank = at(leg[2]) - at(leg[1]);
      const double flexion = std::acos(thigh.normalized().dot(shank.normalized()));
      EXPECT_LT(flexion / kRadiansPerDegree, 15) << "frame " << frame;
    }
  }
}

TEST(ShortWalk, OfOneStepGoesFromStandingToStanding) {
  const auto prints = prints_of({.steps = 0});
  const auto made = walk(walking(), prints, kLevel, {});
  ASSERT_TRUE(made.ok()) << made.error().message;
  EXPECT_GT(made->clip.frame_count(), 10);
}

// Would fail if bones grew and shrank between steps of the one side and mirror images of the
// other's, where a person's sides are unequal.
TEST(Walk, BonesAreThoseOfTheSkeletonWhereSidesAreUnequal) {
  std::vector<parametric::test::KeyedWalk> walks = parametric::test::grid_walks(true);
  auto library = parametric::test::library_of(walks, {"step.length", "step.height", "step.turn"},
                                              {.mirror = false, .outlier = 0})
                     .library;
  const int hand = library.skeleton.find("LeftHand");
  const int elbow = library.skeleton.parents[at(hand)];
  for (std::size_t i = 0; i < library.examples.size(); i += 2) {
    Clip& motion = library.examples[i].motion;
    LocalMotion local = local_motion(motion);
    for (Vec3& place : local.joint_positions(hand)) place *= 1.08;
    set_local_motion(local, motion);
  }
  std::vector<StepLibrary> libraries;
  libraries.push_back(test::walking_library(std::move(library)));
  const auto made = walk(libraries, prints_of({.steps = 6}), kLevel, {});
  ASSERT_TRUE(made.ok()) << made.error().message;
  const Clip& clip = made->clip;
  const double length = clip.skeleton.reference_local(hand).position.norm();
  for (int f = 0; f < clip.frame_count(); ++f) {
    const auto places = clip.frame_positions(f);
    EXPECT_NEAR((places[at(hand)] - places[at(elbow)]).norm(), length, 1e-5) << f;
  }
}

}  // namespace
}  // namespace krok::gait
