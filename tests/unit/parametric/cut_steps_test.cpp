// If these fail, steps are cut out of walks where there are none, or their parameters are not those
// of the walk, so that a library asked for a step gives another one.

#include "parametric/cut_steps.h"

#include <gmock/gmock.h>

#include "walks.h"

namespace krok::parametric {
namespace {

using samples::WalkOptions;
using testing::HasSubstr;

constexpr double kMillimetre = 1e-3;
constexpr double kTenthDegree = 0.1 * kRadiansPerDegree;

// A straight step of feet that point outward turns by nothing, and one of a curve by what the path
// turns, for either foot.
TEST(CutSteps, ThePathTurnsWithoutTheToes) {
  for (const double turn : {0.0, 15.0}) {
    WalkOptions walk;
    walk.steps = 12;
    walk.step_length = 0.6;
    walk.turn = turn * kRadiansPerDegree;
    std::vector<test::KeyedWalk> walks;
    walks.push_back(test::keyed_walk(walk));
    for (const FootSide swing : {FootSide::left, FootSide::right}) {
      CutOptions options;
      options.swing = swing;
      options.mirror = false;
      const Library library =
          test::library_of(walks, {"step.turn", "step.path_turn"}, options).library;
      ASSERT_GE(library.examples.size(), 3u);
      const double toes = library.foot(swing).toe_out - library.foot(library.stance()).toe_out;
      const double side = swing == FootSide::left ? 1 : -1;
      EXPECT_GT(std::abs(toes), 5 * kRadiansPerDegree);
      for (const Example& example : library.examples) {
        EXPECT_NEAR(example.parameters[1], side * walk.turn, 1.5 * kRadiansPerDegree);
        EXPECT_NEAR(example.parameters[0] - example.parameters[1], side * toes, 1e-9);
      }
      // The mirrored library measures the same.
      const auto other = mirrored(library);
      ASSERT_TRUE(other.ok());
      const auto again =
          make_example(*other, "again", other->examples[0].motion, other->examples[0].keytimes);
      ASSERT_TRUE(again.ok()) << again.error().message;
      EXPECT_NEAR(again->parameters[1], library.examples[0].parameters[1], 1e-6);
    }
  }
}

// Where a foot is off before the other one strikes, as in a run, steps have that as their keytime.
TEST(CutSteps, RunsHaveAFlight) {
  std::vector<test::KeyedWalk> walks;
  walks.push_back(test::keyed_walk({}));
  auto& keys = walks[0].keys.keytimes;
  for (Keytime& key : keys) {
    if (key.name.ends_with("off")) key.time -= 0.2;
  }
  std::erase_if(keys, [](const Keytime& key) { return key.time < 0; });
  std::ranges::sort(keys, {}, &Keytime::time);
  CutOptions options;
  options.gait = StepGait::run;
  options.outlier = 0;
  const StepLibrary cut = test::library_of(walks, {"step.length"}, options);
  EXPECT_THAT(cut.library.keytimes,
              testing::ElementsAre("stance_strike", "stance_off", "swing_strike"));
  EXPECT_GE(cut.library.examples.size(), 5u);
  EXPECT_TRUE(check(cut.library));
  for (const Example& example : cut.library.examples) {
    EXPECT_GT(example.keytimes[1] - example.keytimes[0], 0.2);
    EXPECT_LT(example.keytimes[1], example.keytimes[2] - 0.05);
  }
  // As steps of a walk they lack a keytime.
  options.gait = StepGait::walk;
  const Walk walk = {"run", &walks[0].walk.clip, &walks[0].keys, &walks[0].found};
  const std::vector<std::string> length = {"step.length"};
  const auto none = cut_steps({&walk, 1}, find_roles(walk.clip->skeleton), length, options);
  ASSERT_FALSE(none.ok());
  EXPECT_EQ(none.error().code, "parametric-none");
}

class CutWalk : public testing::TestWithParam<WalkOptions> {};

TEST_P(CutWalk, StepsAreAsTheyWerePlanned) {
  std::vector<test::KeyedWalk> walks;
  walks.push_back(test::keyed_walk(GetParam()));
  // A level walk, to tell the soles by.
  walks.push_back(test::keyed_walk({}));
  for (const FootSide swing : {FootSide::left, FootSide::right}) {
    CutOptions options;
    options.swing = swing;
    options.mirror = false;
    options.outlier = 0;
    const auto cut = test::library_of(walks, test::kStepParameters, options);
    ASSERT_GE(cut.library.examples.size(), 3u);
    for (const auto& dropped : cut.dropped) ADD_FAILURE() << dropped.reason;
    EXPECT_TRUE(check(cut.library));
    for (const Example& example : cut.library.examples) {
      if (!example.name.starts_with("walk0")) continue;
      // Where in the walk it is, by its number.
      const auto number = std::stoi(example.name.substr(example.name.find(' ') + 1));
      const double first = swing == FootSide::left ? 1 : 2;
      const double strike = (first + 2 * (number - 1)) * walks[0].walk.step_time;
      const auto plan = test::planned_step(walks[0].walk, strike);
      EXPECT_EQ(plan.swing, swing);
      EXPECT_NEAR(example.parameters[0], plan.length, kMillimetre) << example.name;
      EXPECT_NEAR(example.parameters[1], plan.width, kMillimetre) << example.name;
      EXPECT_NEAR(example.parameters[2], plan.height, kMillimetre) << example.name;
      EXPECT_NEAR(example.parameters[3], plan.turn, kTenthDegree) << example.name;
      EXPECT_NEAR(example.parameters[4], plan.duration, 1e-3) << example.name;
    }
  }
}

WalkOptions walk(double length, double width, double turn, double rise, samples::Ground ground) {
  WalkOptions options;
  options.step_length = length;
  options.step_width = width;
  options.turn = turn;
  options.rise = rise;
  options.ground = ground;
  return options;
}

INSTANTIATE_TEST_SUITE_P(Walks, CutWalk,
                         testing::Values(walk(0.7, 0.1, 0, 0, samples::Ground::slope),
                                         walk(0.4, 0.2, 0, 0, samples::Ground::slope),
                                         walk(0.6, 0.1, 0.4, 0, samples::Ground::slope),
                                         walk(0.6, 0.1, -0.3, 0.05, samples::Ground::slope),
                                         walk(0.6, 0.1, 0, -0.05, samples::Ground::slope)));

// Down stairs the ball comes down first, up stairs the sole: where the heel will stand is told from
// the estimated sole alone.
TEST(CutSteps, StepsOnStairsAreAsPlannedWithinThreeMillimetres) {
  for (const double rise : {-0.15, 0.15}) {
    std::vector<test::KeyedWalk> walks;
    walks.push_back(test::keyed_walk(walk(0.5, 0.15, 0.2, rise, samples::Ground::stairs)));
    walks.push_back(test::keyed_walk({}));
    const auto cut =
        test::library_of(walks, test::kStepParameters, {.mirror = false, .outlier = 0});
    const auto plan = test::planned_step(walks[0].walk, walks[0].walk.step_time);
    ASSERT_FALSE(cut.library.examples.empty());
    const auto& measured = cut.library.examples[0].parameters;
    EXPECT_NEAR(measured[0], plan.length, 3 * kMillimetre);
    EXPECT_NEAR(measured[1], plan.width, 3 * kMillimetre);
    EXPECT_NEAR(measured[2], plan.height, 3 * kMillimetre);
    EXPECT_NEAR(measured[3], plan.turn, kTenthDegree);
  }
}

// A step of the right foot seen in a mirror is one of the left foot with the same parameters.
TEST(CutSteps, MirroredStepsMeasureAsTheirOriginals) {
  std::vector<test::KeyedWalk> walks;
  walks.push_back(test::keyed_walk(walk(0.6, 0.12, 0.1, 0, samples::Ground::stairs)));
  CutOptions right{.swing = FootSide::right, .mirror = false};
  const auto originals = test::library_of(walks, test::kStepParameters, right);
  const auto both = test::library_of(walks, test::kStepParameters, {});
  std::vector<const Example*> images;
  for (const Example& example : both.library.examples) {
    if (example.mirrored) images.push_back(&example);
  }
  ASSERT_EQ(images.size(), originals.library.examples.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    EXPECT_THAT(images[i]->name, HasSubstr("right"));
    for (std::size_t d = 0; d < test::kStepParameters.size(); ++d) {
      EXPECT_NEAR(images[i]->parameters[d], originals.library.examples[i].parameters[d], 2e-5);
    }
  }
}

TEST(CutSteps, PosesThatJumpAreDropped) {
  std::vector<test::KeyedWalk> walks;
  walks.push_back(test::keyed_walk({}));
  Clip& clip = walks[0].walk.clip;
  std::vector<Transform> pose(clip.skeleton.reference);
  clip.set_pose(0, pose);  // a rest pose before the capture
  const auto cut = test::library_of(walks, test::kStepParameters);
  ASSERT_EQ(cut.dropped.size(), 1u);
  EXPECT_THAT(cut.dropped[0].reason, HasSubstr("jumps"));
  EXPECT_EQ(cut.dropped[0].start, 0);
}

TEST(CutSteps, SaysWhyStepsAreDropped) {
  const auto reasons = [](const std::function<void(test::KeyedWalk&)>& change, CutOptions options) {
    std::vector<test::KeyedWalk> walks;
    walks.push_back(test::keyed_walk({}));
    change(walks[0]);
    std::string all;
    for (const auto& dropped : test::library_of(walks, test::kStepParameters, options).dropped) {
      all += dropped.reason + "; ";
    }
    return all;
  };
  const auto erase = [](const char* name) {
    return [name](test::KeyedWalk& walk) {
      auto& keys = walk.keys.keytimes;
      keys.erase(std::ranges::find(keys, name, &Keytime::name) + 1 - 1);
    };
  };
  EXPECT_EQ(reasons([](test::KeyedWalk&) {}, {}), "");
  EXPECT_THAT(reasons(erase("left_off"), {}), HasSubstr("no left_off between the strikes"));
  EXPECT_THAT(reasons(erase("left_strike"), {}),
              HasSubstr("the right foot strikes twice in a row"));
  EXPECT_THAT(reasons(
                  [](test::KeyedWalk& walk) {
                    auto& keys = walk.keys.keytimes;
                    const auto off = std::ranges::find(keys, "left_off", &Keytime::name);
                    keys.insert(off + 1, {off->time + 0.05, "left_off"});
                  },
                  {}),
              HasSubstr("more than one left_off"));
  EXPECT_THAT(reasons(
                  [](test::KeyedWalk& walk) {
                    auto& keys = walk.keys.keytimes;
                    const auto strike = std::ranges::find(keys, "left_strike", &Keytime::name);
                    strike->time -= 0.35;  // half-way, behind the off still
                    std::ranges::sort(keys, {}, &Keytime::time);
                  },
                  {.shortest = 0.3}),
              HasSubstr("too short"));
  EXPECT_THAT(reasons([](test::KeyedWalk&) {}, CutOptions{.mirror = false, .longest = 0.56}), "");
}

// One long step among many short ones.
TEST(CutSteps, OutliersAreDroppedAndNamed) {
  std::vector<test::KeyedWalk> walks;
  auto shorter = walk(0.5, 0.1, 0, 0, samples::Ground::stairs);
  shorter.steps = 24;
  walks.push_back(test::keyed_walk(shorter));
  auto longer = walk(0.8, 0.1, 0, 0, samples::Ground::stairs);
  longer.steps = 2;
  walks.push_back(test::keyed_walk(longer));
  const auto cut = test::library_of(walks, {"step.length"}, {.mirror = false});
  ASSERT_EQ(cut.dropped.size(), 1u);
  EXPECT_EQ(cut.dropped[0].walk, "walk1");
  EXPECT_THAT(cut.dropped[0].reason, HasSubstr("an outlier: step.length is 0.784 m"));
  EXPECT_THAT(test::library_of(walks, {"step.length"}, {.mirror = false, .outlier = 0}).dropped,
              testing::IsEmpty());
  // Where there are several of the kind the library is made of such variations.
  longer.steps = 6;
  walks[1] = test::keyed_walk(longer);
  EXPECT_THAT(test::library_of(walks, {"step.length"}, {.mirror = false}).dropped,
              testing::IsEmpty());
}

TEST(CutSteps, RefusesAnotherSkeletonByName) {
  const auto first = test::keyed_walk({});
  samples::WalkOptions taller;
  taller.stature = 1.9;
  auto second = test::keyed_walk(taller);
  const auto cut = [&] {
    const Walk walks[] = {{"first", &first.walk.clip, &first.keys, nullptr},
                          {"second", &second.walk.clip, &second.keys, nullptr}};
    const std::string parameters[] = {"step.length"};
    return cut_steps(walks, find_roles(first.walk.clip.skeleton), parameters, {});
  };
  auto result = cut();
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, "parametric-skeleton");
  EXPECT_EQ(result.error().where.file, "second");
  second.walk.clip.skeleton.names[3] = "Else";
  EXPECT_EQ(cut().error().code, "parametric-skeleton");
}

// Exporters put the end site of the head now here, now there; the motion is the same.
TEST(CutSteps, EndSitesOffTheFeetMayDiffer) {
  std::vector<test::KeyedWalk> walks;
  walks.push_back(test::keyed_walk({}));
  walks.push_back(test::keyed_walk({}));
  const auto same = test::library_of(walks, {"step.length"}).library;
  Clip& clip = walks[1].walk.clip;
  const auto head = static_cast<std::size_t>(clip.skeleton.find("Head_end"));
  clip.skeleton.reference[head].position.y() += 0.1;
  for (int f = 0; f < clip.frame_count(); ++f) clip.frame_positions(f)[head].y() += 0.1F;
  const auto library = test::library_of(walks, {"step.length"}).library;
  ASSERT_EQ(library.examples.size(), same.examples.size());
  for (std::size_t i = 0; i < same.examples.size(); ++i) {
    const Vec3f ours = library.examples[i].motion.frame_positions(3)[head];
    EXPECT_NEAR((ours - same.examples[i].motion.frame_positions(3)[head]).norm(), 0, 1e-5);
  }
}

TEST(CutSteps, SaysWhenThereIsNothing) {
  const auto standing = test::keyed_walk({});
  const MotionKeys none;
  const std::string parameters[] = {"step.length"};
  const RoleMap roles = find_roles(standing.walk.clip.skeleton);
  const Walk walks[] = {{"stands", &standing.walk.clip, &none, nullptr}};
  EXPECT_EQ(cut_steps({}, roles, parameters, {}).error().code, "parametric-none");
  EXPECT_EQ(cut_steps(walks, roles, parameters, {}).error().code, "parametric-none");
  EXPECT_EQ(cut_steps(walks, roles, {}, {}).error().code, "parametric-parameter");
  RoleMap unknown = roles;
  std::ranges::fill(unknown.roles, Role::none);
  EXPECT_EQ(cut_steps(walks, unknown, parameters, {}).error().code, "parametric-feet");
}

// With the pass of the feet the middle of the swing is a keytime too.
TEST(CutSteps, FindsWhereTheFeetPass) {
  std::vector<test::KeyedWalk> walks;
  walks.push_back(test::keyed_walk({}));
  const auto cut = test::library_of(walks, {"step.length"}, {.pass = true});
  EXPECT_THAT(cut.library.keytimes,
              testing::ElementsAre("stance_strike", "swing_off", "swing_pass", "swing_strike"));
  const Library& library = cut.library;
  ASSERT_FALSE(library.examples.empty());
  for (const Example& example : library.examples) {
    std::vector<Transform> pose(library.skeleton.names.size());
    const double frame = example.keytimes[2] * example.motion.rate;
    const auto ahead = [&](int f) {
      const auto at = [&](FootSide side) {
        return example.motion.frame_positions(f)[static_cast<std::size_t>(library.foot(side).joint)]
            .z();
      };
      return at(library.swing) - at(library.stance());
    };
    EXPECT_LT(ahead(static_cast<int>(std::floor(frame)) - 1), 0);
    EXPECT_GT(ahead(static_cast<int>(std::ceil(frame)) + 1), 0);
  }
}

}  // namespace
}  // namespace krok::parametric
