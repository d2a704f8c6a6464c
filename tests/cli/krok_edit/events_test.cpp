// Cutting by gait events. Would fail if a cut did not begin and end at the keytimes, or if the
// cycle that --cycle chooses did not repeat.
#include <fmt/format.h>

#include <cmath>

#include "cli/motion_fixture.h"

namespace krok::test {
namespace {

// A walk at 60 frames/s whose cycle of two steps takes exactly 60 frames.
class EditEvents : public MotionTest {
 protected:
  void SetUp() override {
    samples::WalkOptions options;
    options.cadence = 120;
    options.steps = 10;
    options.rate = 60;
    write("walk.anim", samples::make_walk(options).value().clip);
    ASSERT_EQ(run_here("krok-keys", {"walk.anim", "-o", "walk.keys.json", "-q"}).exit_code, 0);
    keys_ = json::parse(get(path("walk.keys.json")))["keytimes"];
  }

  // Of the keytime of that name and number, from 1.
  int frame_of(const std::string& name, int number) const {
    for (const json& key : keys_) {
      if (key["name"] == name && --number == 0) {
        return static_cast<int>(std::lround(key["time"].get<double>() * 60));
      }
    }
    ADD_FAILURE() << name;
    return -1;
  }

  json cut_of(std::vector<std::string> options) const {
    options.insert(options.begin(), {"walk.anim", "-o", "out.anim"});
    return report_here("krok-edit", options)["result"]["steps"][0];
  }

  json keys_;
};

TEST_F(EditEvents, FromOneKeytimeToAnother) {
  const json cut = cut_of({"--from", "left_strike[1]", "--to", "left_strike[2]"});
  EXPECT_EQ(cut["first_frame"], frame_of("left_strike", 1));
  EXPECT_EQ(cut["last_frame"], frame_of("left_strike", 2));
  const Clip part = read("out.anim");
  EXPECT_NEAR(part.frame_count() - 1, 60, 1);
  // Without a number the first; a time and a keytime go together.
  const json mixed = cut_of({"--from", "right_off", "--to", "2s"});
  EXPECT_EQ(mixed["first_frame"], frame_of("right_off", 1));
  EXPECT_EQ(mixed["last_frame"], 120);
}

TEST_F(EditEvents, WithoutASidecarKeytimesAreDetected) {
  std::filesystem::remove(path("walk.keys.json"));
  const json cut = cut_of({"--from", "left_strike[2]"});
  EXPECT_EQ(cut["first_frame"], frame_of("left_strike", 2));
}

TEST_F(EditEvents, ACycleIsCutAndLooped) {
  for (const std::string foot : {"auto", "left", "right"}) {
    std::vector<std::string> options = {"walk.anim", "--cycle", foot, "-o", "out.anim"};
    const json steps = report_here("krok-edit", options)["result"]["steps"];
    ASSERT_EQ(steps.size(), 2U);
    EXPECT_EQ(steps[1]["step"], "loop");
    EXPECT_GE(steps[0]["cycle"]["compared"].get<int>(), 2);
    const std::string from = steps[0]["cycle"]["from"];
    if (foot != "auto") {
      EXPECT_EQ(from.substr(0, foot.size()), foot);
    }
    EXPECT_EQ(read("out.anim").frame_count(), 61) << foot;
    EXPECT_LT(steps[0]["cycle"]["angle"].get<double>(), 0.02) << "a generated walk repeats";
  }
  // Within the given ends.
  const json late = cut_of({"--cycle", "left", "--from", "2s"});
  EXPECT_GE(late["first_frame"].get<int>(), 120);
}

// Would fail if the loop of a walk with curves were a stride that turns, which matches a little
// better.
TEST_F(EditEvents, AStraightCycleIsPreferred) {
  samples::WalkOptions options;
  options.cadence = 120;
  options.steps = 10;
  options.rate = 60;
  options.turn = 12 * kRadiansPerDegree;
  write("curve.anim", samples::make_walk(options).value().clip);
  options.turn = 0;
  options.noise_angle = 0.3 * kRadiansPerDegree;
  write("straight.anim", samples::make_walk(options).value().clip);
  ASSERT_EQ(run_here("krok-edit", {"curve.anim", "--append", "straight.anim", "-o", "both.anim"})
                .exit_code,
            0);
  const json steps = report_here(
      "krok-edit", {"both.anim", "--cycle", "auto", "-o", "out.anim"})["result"]["steps"];
  const json& cycle = steps[0]["cycle"];
  EXPECT_LT(cycle["straight"].get<int>(), cycle["compared"].get<int>());
  EXPECT_GT(cycle["angle"].get<double>(), 0.3) << "of the part with noise";
  EXPECT_EQ(steps[1]["turn"], 0);
}

// Would fail if a loop of what is no cycle were made without a word.
TEST_F(EditEvents, EndsThatAreFarApartAreTold) {
  const ToolRun far = run_here(
      "krok-edit", {"walk.anim", "--loop", "--from", "1s", "--to", "1.5s", "-o", "out.anim"});
  EXPECT_EQ(far.exit_code, 0);
  EXPECT_TRUE(has_code(far.err, "edit-seam")) << far.err;
  const ToolRun whole = run_here("krok-edit", {"walk.anim", "--cycle", "auto", "-o", "out.anim"});
  EXPECT_FALSE(has_code(whole.err, "edit-seam")) << whole.err;
}

// A walk put together of two, whose hips jump back by 1.5 m. Would fail if the loop were cut
// through the jump, and its speed pointed backwards.
TEST_F(EditEvents, CyclesWithAJumpAreNotLooped) {
  Clip walk = read("walk.anim");
  const int jump = frame_of("left_strike", 2) + 20;
  for (int f = jump; f < walk.frame_count(); ++f) {
    for (Vec3f& place : walk.frame_positions(f)) place.z() -= 1.5F;
  }
  write("jumps.anim", walk);
  std::filesystem::copy_file(path("walk.keys.json"), path("jumps.keys.json"));
  ASSERT_EQ(run_here("krok-edit", {"jumps.anim", "--cycle", "left", "--loop", "-o", "out.anim"})
                .exit_code,
            0);
  const Clip loop = read("out.anim");
  for (int f = 1; f < loop.frame_count(); ++f) {
    EXPECT_LT((loop.frame_positions(f)[0] - loop.frame_positions(f - 1)[0]).norm(), 0.2F) << f;
  }
}

// Would fail if a take that jumps became a treadmill, or had its feet planted, without a word.
TEST_F(EditEvents, JumpsOfTheHipsAreWarnedOf) {
  Clip walk = read("walk.anim");
  const int jump = walk.frame_count() / 2;
  for (int f = jump; f < walk.frame_count(); ++f) {
    for (Vec3f& place : walk.frame_positions(f)) place.z() -= 1.5F;
  }
  write("jumps.anim", walk);
  const auto edit = [&](const std::string& input, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {input, "-o", "out.anim"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_here("krok-edit", arguments).err;
  };
  for (const char* option : {"--plant", "--treadmill", "--in-place"}) {
    const std::string jumps = edit("jumps.anim", {option});
    EXPECT_TRUE(has_code(jumps, "edit-jump")) << option;
    EXPECT_THAT(jumps, HasSubstr(fmt::format("frame {} of", jump)));
    EXPECT_FALSE(has_code(edit("walk.anim", {option}), "edit-jump")) << option;
    const std::string before = edit("jumps.anim", {option, "--to", fmt::format("{}f", jump - 1)});
    EXPECT_FALSE(has_code(before, "edit-jump")) << option;
  }
}

// Would fail if walks half a cycle apart were joined, and skated, without a word.
TEST_F(EditEvents, JoinsOutOfStepAreWarnedOf) {
  const auto joined_from = [&](const std::string& event) {
    EXPECT_EQ(
        run_here("krok-edit", {"walk.anim", "--from", event, "-o", "second.anim", "-q"}).exit_code,
        0);
    EXPECT_EQ(
        run_here("krok-edit", {"walk.anim", "--to", "left_strike[3]", "-o", "first.anim", "-q"})
            .exit_code,
        0);
    return run_here("krok-edit",
                    {"first.anim", "--append", "second.anim", "--blend", "0", "-o", "out.anim"})
        .err;
  };
  EXPECT_TRUE(has_code(joined_from("right_strike[2]"), "edit-join"));
  EXPECT_FALSE(has_code(joined_from("left_strike[2]"), "edit-join"));
}

TEST_F(EditEvents, KeytimesThatAreNotThereAreNamed) {
  const auto refused = [&](const std::string& from) {
    const ToolRun run = run_here("krok-edit", {"walk.anim", "--from", from, "-o", "x.anim"});
    EXPECT_EQ(run.exit_code, 2) << from;
    return run.err;
  };
  const std::string misspelt = refused("left_strke[2]");
  EXPECT_TRUE(has_code(misspelt, "edit-event")) << misspelt;
  EXPECT_THAT(misspelt, AllOf(HasSubstr("did you mean 'left_strike'?"), HasSubstr("right_off (")));
  EXPECT_THAT(refused("left_strike[40]"), HasSubstr("there are "));
  for (const char* number : {"left_strike[0]", "left_strike[-1]", "left_strike[x]", "left_strike[]",
                             "]", "left_strike[99999999999999999999]"}) {
    EXPECT_TRUE(has_code(refused(number), "edit-event")) << number;
  }
  EXPECT_FALSE(has_code(refused("1.5x"), "edit-event"));
  put("chain.bvh", capture(30));
  const ToolRun chain = run_here("krok-edit", {"chain.bvh", "--cycle", "auto", "-o", "x.anim"});
  EXPECT_EQ(chain.exit_code, 2);
  EXPECT_TRUE(has_code(chain.err, "edit-cycle")) << chain.err;
}

}  // namespace
}  // namespace krok::test
