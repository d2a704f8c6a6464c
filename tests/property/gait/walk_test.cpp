// What holds of every walk, measured on its frames alone. If these fail, feet slide on their
// prints, sink into the ground or hit it, bones change their lengths, or what a walk looks like
// depends on where it goes, how many threads made it or what stands above the hips.

#include <gtest/gtest.h>

#include <random>

#include "gait/plan_prints.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "unit/gait/walkers.h"

namespace krok::gait {
namespace {

using test::Ground;
using test::prints_of;
using test::walking;
using test::Way;

constexpr double kPrintOff = 1e-4;  // metres
constexpr double kHeadingOff = 0.05 * kRadiansPerDegree;
constexpr double kDrift = 2e-4;        // metres
constexpr double kClearance = -0.002;  // metres: a swing foot does not sink deeper than this

Transform joint_at(const Clip& clip, int frame, int joint) {
  return {clip.frame_positions(frame)[static_cast<std::size_t>(joint)].cast<double>(),
          clip.frame_orientations(frame)[static_cast<std::size_t>(joint)].cast<double>()};
}

// Feet are on their prints while flat, and where a contact says that a joint stays it stays.
void expect_on_prints(const WholeWalk& made, const std::vector<Print>& prints,
                      const Terrain& ground) {
  const Clip& clip = made.clip;
  const parametric::Library& library = walking()[0].library();
  for (const Contact& contact : made.details.keys.contacts) {
    const int first = static_cast<int>(std::ceil(contact.start * clip.rate - 1e-6));
    const int last = static_cast<int>(std::floor(contact.end * clip.rate + 1e-6));
    for (int f = first; f <= std::min(last, clip.frame_count() - 1); ++f) {
      ASSERT_LE((joint_at(clip, f, contact.joint).position - contact.place).norm(), kDrift)
          << clip.skeleton.names[static_cast<std::size_t>(contact.joint)] << " frame " << f;
    }
  }
  ASSERT_EQ(made.details.prints.size(), prints.size());
  for (std::size_t k = 0; k < prints.size(); ++k) {
    const auto& foot = library.foot(prints[k].side);
    for (const Contact& contact : made.details.keys.contacts) {
      const GroundedPrint& print = made.details.prints[k];
      if (contact.joint != foot.joint || contact.start < print.strike - 1e-9 ||
          contact.end > print.off + 1e-9) {
        continue;
      }
      const int f = static_cast<int>(std::lround((contact.start + contact.end) / 2 * clip.rate));
      const Transform at = joint_at(clip, f, foot.joint);
      const Vec3 heel = at * foot.heel, forward = at.orientation * foot.forward;
      EXPECT_NEAR(heel.x(), prints[k].x, kPrintOff) << "print " << k + 1;
      EXPECT_NEAR(heel.z(), prints[k].z, kPrintOff) << "print " << k + 1;
      EXPECT_NEAR(wrapped(std::atan2(forward.x(), forward.z()) - prints[k].heading), 0,
                  kHeadingOff);
      // In the plane nearest to the ground under its corners: half the width is SoleWidth of the
      // method, and no plane is nearer to them than a quarter of their warp.
      const Vec3 across = 0.04 * print.up.cross(print.forward);
      double over[4], warp = 0, most = 0;
      for (int c = 0; c < 4; ++c) {
        const Vec3 corner =
            heel + (c < 2 ? 0 : foot.length) * forward + (c % 2 == 0 ? 1 : -1) * across;
        over[c] = corner.y() - ground.at(corner.x(), corner.z(), 1e9)->height;
        most = std::max(most, std::abs(over[c]));
      }
      warp = std::abs(over[0] - over[1] - over[2] + over[3]) / 4;
      EXPECT_LE(most, warp + kPrintOff) << "print " << k + 1;
    }
  }
}

void expect_bones_kept(const Clip& clip) {
  for (int j = 1; j < clip.joint_count(); ++j) {
    const int parent = clip.skeleton.parents[static_cast<std::size_t>(j)];
    if (parent == 0) continue;  // the hips of rigs with a root above them
    const double length = clip.skeleton.reference_local(j).position.norm();
    for (int f = 0; f < clip.frame_count(); f += 7) {
      ASSERT_NEAR((joint_at(clip, f, j).position - joint_at(clip, f, parent).position).norm(),
                  length, 2e-5)
          << clip.skeleton.names[static_cast<std::size_t>(j)];
    }
  }
}

WholeWalk walked(const std::vector<Print>& prints, const Terrain& ground,
                 const WalkOptions& options = {}, int jobs = 1) {
  auto made = walk(walking(), prints, ground, options, jobs);
  EXPECT_TRUE(made.ok()) << made.error().message;
  return made.ok() ? *std::move(made) : WholeWalk{};
}

struct Place {
  std::string name;
  std::function<Ground(std::mt19937_64&)> ground;
};
double between(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

class WalkOn : public testing::TestWithParam<Place> {};
INSTANTIATE_TEST_SUITE_P(
    Grounds, WalkOn,
    testing::Values(
        Place{"Level", [](auto&) { return Ground([](double, double) { return 0.3; }); }},
        Place{"Slope", [](auto& random) { return test::slope(between(random, -0.57, 0.57)); }},
        Place{"Sideways",
              [](auto& random) {
                const double tangent = between(random, -0.4, 0.4);
                return Ground([=](double x, double) { return tangent * x; });
              }},
        Place{"Rough", [](auto& random) { return test::rough(between(random, 0.02, 0.1)); }}),
    [](const auto& given) { return given.param.name; });

TEST_P(WalkOn, FeetStayOnTheirPrintsAndBonesKeepTheirLengths) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 6; ++i) {
    const Way way{.steps = 5 + i,
                  .length = between(random, 0.4, 0.7),
                  .width = between(random, 0.08, 0.2),
                  .turn = between(random, -0.25, 0.25),
                  .toe_out = between(random, 0, 0.2)};
    const std::vector<Print> prints = prints_of(way);
    const Ground ground = GetParam().ground(random);
    const WholeWalk made = walked(prints, ground);
    ASSERT_GT(made.clip.frame_count(), 0);
    EXPECT_TRUE(check(made.clip).ok());
    EXPECT_TRUE(check(made.details.keys, made.clip.skeleton, made.clip.duration()).ok());
    for (const Diagnostic& warning : made.details.warnings) {
      EXPECT_EQ(warning.code, "walk-ankle") << warning.message;  // slopes of 25 to 30 degrees
    }
    expect_on_prints(made, prints, ground);
    expect_bones_kept(made.clip);
    for (const StepReport& step : made.details.steps) EXPECT_GE(step.clearance, kClearance);
  }
}

// A walker of forward steps turned on the spot, or stepped aside, with its body 0.3 m and more
// away from its feet, and did not lift them, without a warning.
TEST(Walk, StaysOverItsFeetWhereNoExampleIsNear) {
  const Ground level([](double, double) { return 0.0; });
  for (const auto& [turn, aside] : {std::pair{0.5, 0.0}, {0.0, 0.3}}) {
    std::vector<Print> prints;
    double heading = 0, x = 0;
    for (int k = 0; k < 12; ++k) {
      if (k >= 2 && k % 2 == 0) heading += turn, x += aside;
      const bool left = k % 2 == 0;
      const double out = left ? 0.09 : -0.09;
      // Both feet about one point, 8 cm before the heels.
      prints.push_back({left ? FootSide::left : FootSide::right,
                        x + out * std::cos(heading) - 0.08 * std::sin(heading),
                        -out * std::sin(heading) - 0.08 * std::cos(heading),
                        heading,
                        {},
                        {}});
    }
    const WholeWalk made = walked(prints, level);
    ASSERT_GT(made.clip.frame_count(), 0);
    for (const Diagnostic& warning : made.details.warnings) {
      EXPECT_EQ(warning.code, "walk-beyond") << warning.message;
    }
    const RoleMap roles = find_roles(made.clip.skeleton);
    for (int f = 0; f < made.clip.frame_count(); ++f) {
      const Vec3 feet = 0.5 * (joint_at(made.clip, f, roles.joint(Role::left_foot)).position +
                               joint_at(made.clip, f, roles.joint(Role::right_foot)).position);
      const Vec3 off = joint_at(made.clip, f, roles.joint(Role::hips)).position - feet;
      ASSERT_LE(std::hypot(off.x(), off.z()), 0.2) << "frame " << f;
    }
    for (const StepReport& step : made.details.steps) {
      EXPECT_GE(step.clearance, WalkOptions().clearance - 5e-4) << "step over " << step.stance;
    }
  }
}

TEST(Walk, IsTheSameWhereverItGoes) {
  const Transform moved{{3, 0.5, -7}, axis_rotation(Axis::y, 2.1)};
  const auto height = [](double x, double z) {
    return 0.05 * std::sin(2 * x) + 0.1 * std::clamp(z, 0.0, 3.0);
  };
  const Ground here(height);
  const Ground there([&](double x, double z) {
    const Vec3 back = moved.inverse() * Vec3(x, moved.position.y(), z);
    return height(back.x(), back.z()) + moved.position.y();
  });
  std::vector<Print> prints = prints_of({.steps = 7, .turn = 0.1});
  const WholeWalk first = walked(prints, here);
  for (Print& print : prints) {
    const Vec3 at = moved * Vec3(print.x, 0, print.z);
    print.x = at.x();
    print.z = at.z();
    print.heading += 2.1;
  }
  const WholeWalk second = walked(prints, there);
  ASSERT_EQ(first.clip.frame_count(), second.clip.frame_count());
  for (std::size_t i = 0; i < first.clip.positions.size(); ++i) {
    const Vec3 at = moved * first.clip.positions[i].cast<double>();
    ASSERT_LE((at - second.clip.positions[i].cast<double>()).norm(), 2e-4) << i;
  }
}

TEST(Walk, HasTheSameBytesOnAnyNumberOfThreadsAndInAnyOrder) {
  const std::vector<Print> prints = prints_of({.steps = 150, .turn = 0.05});
  const Ground ground = test::rough(0.05);
  const WholeWalk one = walked(prints, ground, {.rate = 30}, 1);
  const WholeWalk three = walked(prints, ground, {.rate = 30}, 3);
  ASSERT_EQ(one.clip.positions.size(), three.clip.positions.size());
  EXPECT_TRUE(one.clip.positions == three.clip.positions);
  // Single frames from the last to the first, memory released in between.
  const auto again = Walk::plan(walking(), prints, ground, {.rate = 30});
  ASSERT_TRUE(again.ok());
  const std::size_t joints = one.clip.skeleton.names.size();
  std::vector<Vec3f> positions(joints);
  std::vector<Quatf> orientations(joints);
  for (int f = one.clip.frame_count() - 1; f >= 0; f -= 301) {
    ASSERT_TRUE(again->frames().read(f, 1, positions, orientations).ok());
    again->frames().release(one.clip.frame_count());
    const auto expected = one.clip.frame_positions(f);
    EXPECT_TRUE(std::equal(positions.begin(), positions.end(), expected.begin())) << f;
  }
}

TEST(Walk, StandsAtBothEnds) {
  const std::vector<Print> prints = prints_of({.steps = 6});
  const Ground level([](double, double) { return 0.0; });
  const WholeWalk made = walked(prints, level);
  const int last = made.clip.frame_count() - 1;
  for (const auto& [frame, next, one, two] :
       {std::tuple{0, 1, std::size_t{0}, std::size_t{1}},
        std::tuple{last, last - 1, prints.size() - 1, prints.size() - 2}}) {
    for (const std::size_t k : {one, two}) {
      const auto& foot = walking()[0].library().foot(prints[k].side);
      const Vec3 heel = joint_at(made.clip, frame, foot.joint) * foot.heel;
      EXPECT_NEAR(heel.x(), prints[k].x, kPrintOff);
      EXPECT_NEAR(heel.z(), prints[k].z, kPrintOff);
    }
    for (int j = 0; j < made.clip.joint_count(); ++j) {
      const Vec3 way =
          joint_at(made.clip, frame, j).position - joint_at(made.clip, next, j).position;
      EXPECT_LE(way.norm() * made.clip.rate, 0.02)
          << made.clip.skeleton.names[static_cast<std::size_t>(j)] << ", metres per second";
    }
  }
}

// Knees pop where a foot is forced onto its print by a leg that is nearly straight.
TEST(Walk, KneesAreAsCalmAsTheExamples) {
  const auto calm = [](const Clip& clip) {
    const RoleMap roles = find_roles(clip.skeleton);
    double largest = 0;
    for (const auto& [hip, knee, foot] :
         {std::tuple{Role::left_upper_leg, Role::left_lower_leg, Role::left_foot},
          std::tuple{Role::right_upper_leg, Role::right_lower_leg, Role::right_foot}}) {
      std::vector<double> angles;
      for (int f = 0; f < clip.frame_count(); ++f) {
        const Vec3 at = joint_at(clip, f, roles.joint(knee)).position;
        const Vec3 up = joint_at(clip, f, roles.joint(hip)).position - at;
        const Vec3 down = joint_at(clip, f, roles.joint(foot)).position - at;
        angles.push_back(std::acos(std::clamp(up.normalized().dot(down.normalized()), -1.0, 1.0)));
      }
      for (std::size_t i = 2; i < angles.size(); ++i) {
        largest = std::max(largest, std::abs(angles[i] - 2 * angles[i - 1] + angles[i - 2]) *
                                        clip.rate * clip.rate);
      }
    }
    return largest;
  };
  double examples = 0;
  for (const auto& example : walking()[0].library().examples) {
    examples = std::max(examples, calm(example.motion));
  }
  const Ground level([](double, double) { return 0.0; });
  for (const double length : {0.45, 0.6, 0.7}) {
    const WholeWalk made = walked(prints_of({.steps = 8, .length = length}), level,
                                  {.rate = walking()[0].library().rate});
    EXPECT_LE(calm(made.clip), 1.5 * examples) << length;
  }
}

TEST(Walk, IsTheSameWhateverStandsAboveTheHips) {
  const std::vector<Print> prints = prints_of({.steps = 5, .turn = 0.1});
  const Ground level([](double, double) { return 0.0; });
  const WholeWalk first = walked(prints, level);
  for (const samples::Rig rig :
       {samples::Rig::static_root, samples::Rig::ground_root, samples::Rig::lying}) {
    std::vector<StepLibrary> libraries;
    libraries.push_back(test::walking_library(rig));
    const auto made = walk(libraries, prints, level, {});
    ASSERT_TRUE(made.ok()) << made.error().message;
    ASSERT_NEAR(made->clip.frame_count(), first.clip.frame_count(), 1);
    for (const Role role : {Role::hips, Role::head, Role::left_hand, Role::right_foot}) {
      const int here = find_roles(first.clip.skeleton).joint(role);
      const int there = find_roles(made->clip.skeleton).joint(role);
      for (int f = 0; f < std::min(first.clip.frame_count(), made->clip.frame_count()); ++f) {
        ASSERT_LE((joint_at(first.clip, f, here).position - joint_at(made->clip, f, there).position)
                      .norm(),
                  3e-3)
            << role_name(role) << " frame " << f;
      }
    }
  }
}

// Ways to random goals, near and behind too. If this fails, footprints that krok-walk planned
// itself are refused: in sharp bends feet stood on each other.
TEST(Walk, PlannedWaysCanBeWalked) {
  std::mt19937_64 random(5);
  const Ground level([](double, double) { return 0.0; });
  const auto options = usual_steps(walking());
  ASSERT_TRUE(options.ok());
  for (int i = 0; i < 40; ++i) {
    std::vector<Vec2> goals;
    Vec2 at = Vec2::Zero();
    for (int k = 0; k < 1 + i % 4; ++k) {
      at += Vec2(between(random, -3, 3), between(random, -3, 3));
      goals.push_back(at);
    }
    const auto path = Path::create(way_to_goals(0, 0, 0, goals));
    ASSERT_TRUE(path.ok());
    const auto prints = plan_prints(*path, level, *options);
    ASSERT_TRUE(prints.ok()) << prints.error().message;
    const auto made = Walk::plan(walking(), prints->prints, level, {});
    EXPECT_TRUE(made.ok()) << "way " << i << ": " << made.error().message;
  }
}

}  // namespace
}  // namespace krok::gait
