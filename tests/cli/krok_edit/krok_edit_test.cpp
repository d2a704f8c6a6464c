// If these fail, krok-edit does another thing than its help says, does steps in another order, or
// leaves its user without a word about what it did.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/motion_fixture.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/local_motion.h"
#include "motion/sample.h"
#include "motion/travel.h"
#include "roles/body_frame.h"
#include "samples/generator/walk.h"

namespace krok::test {
namespace {

class KrokEdit : public test::MotionTest {
 protected:
  test::ToolRun edit(std::vector<std::string> arguments) {
    return run_here("krok-edit", std::move(arguments));
  }

  // Edits walk.anim to out.anim, which must work.
  Clip edited(std::vector<std::string> options) {
    options.insert(options.begin(), {"walk.anim", "-o", "out.anim"});
    const auto done = edit(options);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    last_message_ = done.err;
    return read("out.anim");
  }

  nlohmann::json report_of(std::vector<std::string> options) {
    options.insert(options.begin(), {"walk.anim", "-o", "out.anim", "--json"});
    const auto done = edit(options);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return nlohmann::json::parse(done.out);
  }

  std::string last_message_;
};

// A cycle of two steps takes exactly 60 frames; 241 frames in all.
Clip walk(double noise = 0) {
  samples::WalkOptions options;
  options.cadence = 120;
  options.noise_angle = noise;
  Clip clip = samples::make_walk(options).value().clip;
  clip.provenance = {"krok-import",
                     "0.0.9",
                     {{"walk.bvh", "0011223344556677"}},
                     {{"unit", "cm"}, {"strict", "true"}},
                     {"unit: cm"},
                     {"a warning [code]"}};
  return clip;
}

TEST_F(KrokEdit, CutsBySecondsAndFramesEndsIncluded) {
  write("walk.anim", walk());
  const Clip whole = read("walk.anim");
  const Clip part = edited({"--from", "1.5s", "--to", "120f"});
  EXPECT_EQ(part.positions, cut(whole, 90, 120).positions);
  EXPECT_THAT(last_message_, HasSubstr("cut: frames 90 to 120, 210 removed"));
  EXPECT_EQ(edited({"--from", "239f"}).frame_count(), 2);
  EXPECT_EQ(edited({"--to", "500ms"}).frame_count(), 31);
  EXPECT_EQ(edited({"--from", "2", "--to", "2"}).frame_count(), 1);
  // Moments between frames: the frames within.
  EXPECT_EQ(edited({"--from", "0.99s", "--to", "1.01s"}).frame_count(), 1);
  EXPECT_EQ(edited({"--to", "4.01s"}).frame_count(), 241);
}

TEST_F(KrokEdit, RangesThatCannotBeAreErrors) {
  write("walk.anim", walk());
  const auto refused = [&](std::vector<std::string> options, const char* code) {
    options.insert(options.begin(), {"walk.anim", "-o", "out.anim"});
    const auto done = edit(options);
    EXPECT_EQ(done.exit_code, 2) << done.err;
    EXPECT_TRUE(test::has_code(done.err, code)) << done.err;
    EXPECT_FALSE(std::filesystem::exists(path("out.anim")));
    return done.err;
  };
  EXPECT_THAT(refused({"--from", "2s", "--to", "1s"}, "edit-range"), HasSubstr("after --to (1 s)"));
  EXPECT_THAT(refused({"--from", "9s"}, "edit-range"), HasSubstr("241 frames, 0 to 240, 4 s"));
  refused({"--to", "300f"}, "edit-range");
  refused({"--from", "1.001s", "--to", "1.002s"}, "edit-range");
  refused({"--from", "-1s"}, "usage");
  refused({"--from", "1deg"}, "quantity-unit");
  refused({"--from", "soon"}, "edit-event");
  refused({"--from", "1.5x"}, "quantity-unit");
}

TEST_F(KrokEdit, NamedSequencesWithSpeedAndLoop) {
  write("walk.anim", walk());
  put("take.json", R"({"schema": "krok.sequences/1", "rate": 30, "sequences": [
    {"name": "cycle", "first": 10, "last": 40, "loop": true, "speed": 2},
    {"name": "rest", "first": 50, "last": 60}]})");
  const auto list = edit({"walk.anim", "--sequences", "take.json", "--list-sequences"});
  EXPECT_EQ(list.exit_code, 0) << list.err;
  EXPECT_EQ(list.out, "cycle: frames 10 to 40, speed 2, loop\nrest: frames 50 to 60\n");
  // Counted at 30 a second: frames 20 to 80 at 60, then twice as fast.
  const Clip cycle = edited({"--sequences", "take.json", "--sequence", "cycle"});
  EXPECT_EQ(cycle.frame_count(), 31);
  EXPECT_EQ(cycle.rate, 60);
  EXPECT_THAT(last_message_, HasSubstr("cut: sequence 'cycle', frames 20 to 80"));
  EXPECT_THAT(last_message_, HasSubstr("looped: a cycle of 30 frames (0.5 s) moves by 1.4 m"));
  EXPECT_EQ(edited({"--sequences", "take.json", "--sequence", "rest"}).frame_count(), 21);
  const auto unknown =
      edit({"walk.anim", "-o", "x.anim", "--sequences", "take.json", "--sequence", "run"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("take.json: error: there is no sequence 'run'"));
}

TEST_F(KrokEdit, MistakesInSequencesHaveAPlace) {
  write("walk.anim", walk());
  put("take.json",
      "{\"schema\": \"krok.sequences/1\",\n \"sequences\": [{\"name\": \"a\", "
      "\"first\": 9, \"last\": 3}]}");
  const auto bad =
      edit({"walk.anim", "-o", "x.anim", "--sequences", "take.json", "--sequence", "a"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, HasSubstr("take.json:2:50: error: 'a' ends at frame 3, before"));
  put("late.json",
      "{\"schema\": \"krok.sequences/1\", \"sequences\": [{\"name\": \"a\", "
      "\"first\": 9, \"last\": 241}]}");
  const auto late =
      edit({"walk.anim", "-o", "x.anim", "--sequences", "late.json", "--sequence", "a"});
  EXPECT_THAT(late.err, HasSubstr("but the motion has 241 frames, 0 to 240"));
}

TEST_F(KrokEdit, SpikesAreListedWithJointAndFrame) {
  Clip clip = walk();
  LocalMotion motion = local_motion(clip);
  const int arm = clip.skeleton.find("LeftForeArm");
  motion.joint_orientations(arm)[100] =
      motion.joint_orientations(arm)[100] * from_rotation_vector(Vec3(0, 0.7, 0));
  set_local_motion(motion, clip);
  write("walk.anim", clip);
  const auto report = report_of({"--spikes"});
  const auto& step = report["result"]["steps"][0];
  EXPECT_EQ(step["step"], "spikes");
  ASSERT_EQ(step["spikes"].size(), 1u);
  EXPECT_EQ(step["spikes"][0]["joint"], "LeftForeArm");
  EXPECT_EQ(step["spikes"][0]["first_frame"], 100);
  EXPECT_EQ(report["issues"][0]["joint"], "LeftForeArm");
  EXPECT_EQ(report["issues"][0]["frame"], 100);
  const auto told = edit({"walk.anim", "-o", "out.anim", "--spikes", "-v"});
  EXPECT_THAT(told.err, HasSubstr("LeftForeArm, frame 100: the rotation jumped by 40.1 deg"));
  EXPECT_THAT(told.err, HasSubstr("1 spike removed"));
}

TEST_F(KrokEdit, FiltersAndSaysWhatItCosts) {
  write("walk.anim", walk(0.01));
  const auto report = report_of({"--filter", "butterworth", "--cutoff", "8Hz", "--below", "Spine"});
  const auto& step = report["result"]["steps"][0];
  EXPECT_EQ(step["kind"], "butterworth");
  EXPECT_EQ(step["cutoff"], 8);
  EXPECT_LT(step["joints"].get<int>(), 20);
  EXPECT_TRUE(step["feet_moved"].contains("distance"));
  EXPECT_EQ(edited({"--filter", "savgol", "--window", "11", "--filter-order", "4"}).frame_count(),
            241);
  EXPECT_THAT(last_message_, HasSubstr("Savitzky-Golay, 11 frames, degree 4"));
  EXPECT_THAT(last_message_, HasSubstr("feet moved by at most"));
  EXPECT_EQ(edited({"--filter", "savgol", "--window", "301"}).positions,
            read("walk.anim").positions);
  EXPECT_THAT(last_message_, HasSubstr("[edit-short]"));
  for (const auto& [options, code] :
       {std::pair<std::vector<std::string>, std::string>{{"--cutoff", "30Hz"}, "filter-cutoff"},
        {{"--cutoff", "6deg"}, "quantity-unit"},
        {{"--filter-order", "3"}, "filter-order"},
        {{"--joints", "Tail"}, "motion-joint"}}) {
    std::vector<std::string> all = {"walk.anim", "-o", "x.anim", "--filter", "butterworth"};
    all.insert(all.end(), options.begin(), options.end());
    const auto done = edit(all);
    EXPECT_EQ(done.exit_code, 2);
    EXPECT_TRUE(test::has_code(done.err, code)) << done.err;
  }
}

// Would fail if the frames after a T-pose in front of a capture were thrown by metres without a
// word.
TEST_F(KrokEdit, ARestPoseIsNotFilteredWithoutAWord) {
  Clip posed = walk();
  posed.set_pose(0, posed.skeleton.reference);
  write("posed.anim", posed);
  for (const std::vector<std::string>& cleaning :
       {std::vector<std::string>{"--filter", "butterworth"}, {"--filter", "auto"}, {"--spikes"}}) {
    std::vector<std::string> arguments = {"posed.anim", "-o", "out.anim"};
    arguments.insert(arguments.end(), cleaning.begin(), cleaning.end());
    const auto done = edit(arguments);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_TRUE(test::has_code(done.err, "edit-rest-frame")) << done.err;
    arguments[0] = "walk.anim";
    EXPECT_FALSE(test::has_code(edit(arguments).err, "edit-rest-frame"));
  }
}

TEST_F(KrokEdit, LoopsAndRepeats) {
  write("walk.anim", walk());
  const auto report = report_of({"--from", "20f", "--to", "84f", "--loop", "--rounds", "3"});
  const auto& step = report["result"]["steps"][1];
  EXPECT_EQ(step["step"], "loop");
  EXPECT_GT(step["seam_before"]["angle"].get<double>(), 0.05);
  EXPECT_LT(step["seam_after"]["angle"].get<double>(), 1e-9);
  EXPECT_EQ(report["result"]["frames"], 3 * 64 + 1);
  const Clip still = edited({"--from", "20f", "--to", "80f", "--loop", "--treadmill"});
  const GroundFrame first = ground_frame(still, 0, 0), last = ground_frame(still, 0, 60);
  EXPECT_NEAR(first.z, last.z, 1e-5);
  EXPECT_LT((still.frame_positions(0)[9] - still.frame_positions(60)[9]).norm(), 1e-5f);
  const auto lonely = edit({"walk.anim", "-o", "x.anim", "--rounds", "3"});
  EXPECT_EQ(lonely.exit_code, 2);
}

TEST_F(KrokEdit, MirrorsAndNamesWhatHasNoPartner) {
  const Clip clip = walk();
  write("walk.anim", clip);
  const Clip twice = [&] {
    edited({"--mirror"});
    EXPECT_THAT(last_message_, HasSubstr("mirrored: 11 pairs, 7 joints in the middle"));
    std::filesystem::rename(path("out.anim"), path("once.anim"));
    EXPECT_EQ(edit({"once.anim", "-o", "out.anim", "--mirror"}).exit_code, 0);
    return read("out.anim");
  }();
  EXPECT_LT((twice.frame_positions(77)[9] - clip.frame_positions(77)[9]).norm(), 1e-5f);
  EXPECT_EQ(read("once.anim").provenance.conversions.size(), 3u);
  Skeleton odd;
  odd.add("Hips", -1, {Vec3(0, 1, 0), Quat::Identity()});
  odd.add("LeftArm", 0, {Vec3(0.6, 1, 0), Quat::Identity()});
  Clip small;
  small.skeleton = odd;
  small.resize(2);
  write("odd.anim", small);
  const auto done = edit({"odd.anim", "-o", "out.anim", "--mirror"});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("warning: LeftArm has no counterpart on the other side"));
}

// A file with tens of thousands of such joints must neither flood a terminal nor swell its result;
// the report has all.
TEST_F(KrokEdit, ShowsTwentyOfManyWarningsAlike) {
  Clip star;
  star.skeleton.add("Hips", -1, {Vec3(0, 1, 0), Quat::Identity()});
  for (int i = 0; i < 60; ++i) {
    star.skeleton.add(fmt::format("ray{}_left", i), 0, {Vec3(0.6, 1, 0.1 * i), Quat::Identity()});
  }
  star.resize(2);
  write("star.anim", star);
  const auto lines = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
  };
  const auto run = edit({"star.anim", "-o", "out.anim", "--mirror", "--json=report.json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_LT(lines(run.err), 30) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no joints were recognised as left and right"));
  EXPECT_THAT(run.err, HasSubstr("more of these warnings are not shown; -v and --json have all"));
  EXPECT_LT(read("out.anim").provenance.warnings.size(), 30u);
  EXPECT_GE(nlohmann::json::parse(get(path("report.json")))["issues"].size(), 60u);
  EXPECT_GT(lines(edit({"star.anim", "-o", "out.anim", "--mirror", "-v"}).err), 60);
}

TEST_F(KrokEdit, AppendsOnlyTheSameSkeleton) {
  write("walk.anim", walk());
  EXPECT_EQ(
      edited({"--append", "walk.anim", "--append", "walk.anim", "--blend", "0"}).frame_count(),
      721);
  EXPECT_EQ(edited({"--append", "walk.anim"}).frame_count(), 481 - 12);
  Clip other = walk();
  other.skeleton.names[4] = "Rib";
  write("other.anim", other);
  const auto done = edit({"walk.anim", "-o", "x.anim", "--append", "other.anim"});
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_THAT(done.err, HasSubstr("other.anim: error: the skeletons differ"));
  EXPECT_THAT(done.err, HasSubstr("Rib"));
  EXPECT_THAT(done.err, HasSubstr("krok-retarget"));
}

TEST_F(KrokEdit, EveryMotionThatIsAppendedStandsInTheProvenance) {
  std::filesystem::create_directories(path("more"));
  for (const char* name : {"walk.anim", "more/b.anim", "more/c.anim"}) write(name, walk());
  using Given = std::pair<std::string, std::string>;
  const Provenance made =
      edited({"--append", "more/b.anim", "--blend", "0.1s", "--append", "more/c.anim"}).provenance;
  EXPECT_THAT(made.options,
              testing::ElementsAre(Given{"append", "b.anim"}, Given{"append", "c.anim"},
                                   Given{"blend", "0.1s"}));
  ASSERT_EQ(made.sources.size(), 4u);  // walk.bvh, and the three
  EXPECT_EQ(made.sources[3].name, "c.anim");
  const auto again = edit({"out.anim", "-o", "again.anim", "--mirror"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(read("again.anim").provenance.conversions,
              testing::Contains(HasSubstr(" --append b.anim --append c.anim --blend 0.1s")));
}

TEST_F(KrokEdit, PlacesScalesAndGrounds) {
  write("walk.anim", walk());
  const Clip clip = edited({"--height", "1m", "--at-origin", "--heading", "90deg", "--turn", "-30",
                            "--move", "1m, 0,-20cm", "--on-ground"});
  EXPECT_NEAR(stature_of(clip.skeleton, find_roles(clip.skeleton))->metres, 1, 1e-6);
  const GroundFrame start = ground_frame(clip, 0, 0);
  EXPECT_NEAR(start.x, 1, 1e-5);
  EXPECT_NEAR(start.z, -0.2, 1e-5);
  EXPECT_NEAR(start.heading, 60 * kRadiansPerDegree, 1e-5);
  EXPECT_EQ(edited({"--scale", "2"}).frame_count(), 241);
  // A capture in centimetres, one would think.
  edited({"--scale", "100"});
  EXPECT_THAT(last_message_, HasSubstr("[motion-scale]"));
  const Clip still = edited({"--in-place"});
  EXPECT_NEAR(ground_frame(still, 0, 200).z, ground_frame(still, 0, 0).z, 1e-5);
}

TEST_F(KrokEdit, TimingAndTheOrderOfSteps) {
  write("walk.anim", walk());
  const Clip fast = edited({"--playback-speed", "2", "--rate", "30", "--to", "1s"});
  EXPECT_EQ(fast.rate, 30);
  EXPECT_EQ(fast.frame_count(), 16);
  // The order on the command line means nothing.
  edited({"--mirror", "--from", "1s", "--playback-speed", "1.5"});
  const std::string one = get(path("out.anim"));
  const Clip other = edited({"--playback-speed", "1.5", "--from", "1s", "--mirror"});
  EXPECT_EQ(other.positions, [&] {
    put("again.anim", one);
    return read("again.anim").positions;
  }());
  const auto report = report_of({"--turn", "10", "--loop", "--mirror", "--from", "1s", "--filter",
                                 "savgol", "--scale", "2", "--rate", "30", "--treadmill",
                                 "--append", "walk.anim", "--spikes"});
  std::vector<std::string> steps;
  for (const auto& step : report["result"]["steps"]) steps.push_back(step["step"]);
  EXPECT_THAT(steps, testing::ElementsAre("spikes", "filter", "cut", "mirror", "timing", "append",
                                          "loop", "travel", "scale", "place"));
}

// Few frames of a walk, brought back to its rate: curves come nearer to it than straight lines.
TEST_F(KrokEdit, InterpolatesOnCurvesWhereAsked) {
  write("walk.anim", walk());
  const Clip whole = walk(), few = edited({"--rate", "10"});
  write("few.anim", few);
  const auto error_of = [&](const char* how) {
    const ToolRun done =
        edit({"few.anim", "-o", "many.anim", "--rate", "60", "--interpolation", how});
    EXPECT_EQ(done.exit_code, 0) << done.err;
    const Clip many = read("many.anim");
    float largest = 0;
    for (int f = 12; f + 12 < many.frame_count(); ++f) {
      for (int j = 0; j < many.joint_count(); ++j) {
        const auto joint = static_cast<std::size_t>(j);
        largest = std::max(
            largest, (many.frame_positions(f)[joint] - whole.frame_positions(f)[joint]).norm());
      }
    }
    return largest;
  };
  EXPECT_LT(error_of("hermite"), 0.6F * error_of("linear"));
  EXPECT_GT(error_of("hermite:1"), error_of("hermite"));
  for (const char* wrong : {"cubic", "hermite:2", "hermite:", "linear:0.5"}) {
    EXPECT_EQ(
        edit({"few.anim", "-o", "x.anim", "--rate", "60", "--interpolation", wrong}).exit_code, 2);
  }
  EXPECT_EQ(edit({"few.anim", "-o", "x.anim", "--mirror", "--interpolation", "hermite"}).exit_code,
            2);
}

TEST_F(KrokEdit, KeepsAndExtendsProvenance) {
  write("walk.anim", walk());
  const Provenance made = edited({"--from", "1s", "--mirror"}).provenance;
  EXPECT_EQ(made.tool, "krok-edit");
  ASSERT_EQ(made.sources.size(), 2u);
  EXPECT_EQ(made.sources[0].name, "walk.bvh");
  EXPECT_EQ(made.sources[1].name, "walk.anim");
  EXPECT_THAT(made.conversions,
              testing::ElementsAre("unit: cm", "made by krok-import 0.0.9 --unit cm --strict",
                                   "cut: frames 60 to 240, 60 removed",
                                   "mirrored: 11 pairs, 7 joints in the middle"));
  EXPECT_THAT(made.warnings, testing::ElementsAre("a warning [code]"));
}

TEST_F(KrokEdit, OptionsThatDoNotGoTogether) {
  write("walk.anim", walk());
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--in-place", "--treadmill"},
        {"--scale", "2", "--height", "1m"},
        {"--heading", "1", "--re-orient"},
        {"--sequence", "a"},
        {"--sequences", "walk.anim"},
        {"--joints", "*"},
        {"--move", "1,2"},
        {"--move", "1,2,3,4"},
        {"--height", "-1m"},
        {"--rounds", "0", "--loop"},
        {"--rounds", "2"},
        {"--spike-threshold", "3"},
        {"--cutoff", "banana"},
        {"--cutoff", "6Hz", "--filter", "savgol"},
        {"--window", "3", "--filter", "butterworth"},
        {"--filter-order", "2"},
        {"--below", "Hips"},
        {"--blend", "3s"},
        {"--match-height", "--loop"},
        {"--loop-blend", "1s"},
        {"--loop-end", "open"},
        {"--loop-turn", "keep"},
        {"--loop-climb", "keep"},
        {"--filter", "median"},
        {"--rate", "0"},
        {"--playback-speed", "-1"},
        {"--scale", "0"},
        {"--from", "1s", "--to", "61f", "--loop"}}) {
    std::vector<std::string> all = {"walk.anim", "-o", "x.anim"};
    all.insert(all.end(), options.begin(), options.end());
    const auto done = edit(all);
    EXPECT_EQ(done.exit_code, 2) << options[0] << done.err;
    EXPECT_THAT(done.err, HasSubstr("error: "));
    EXPECT_FALSE(std::filesystem::exists(path("x.anim")));
  }
  EXPECT_EQ(edit({"walk.anim"}).exit_code, 2);
}

// Would fail if a forgotten option left a copy that is taken for the result.
TEST_F(KrokEdit, WithoutAStepNothingIsCopied) {
  write("walk.anim", walk());
  const auto copy = edit({"walk.anim", "-o", "x.anim"});
  EXPECT_EQ(copy.exit_code, 2);
  EXPECT_THAT(copy.err, HasSubstr("no step is requested"));
  EXPECT_FALSE(std::filesystem::exists(path("x.anim")));
  EXPECT_EQ(edited({"--playback-speed", "1"}).positions, read("walk.anim").positions);
  Clip empty = walk();
  empty.resize(0);
  write("walk.anim", empty);
  EXPECT_EQ(edited({"--spikes", "--filter", "butterworth", "--mirror", "--playback-speed", "2",
                    "--in-place", "--at-origin", "--on-ground", "--scale", "2"})
                .frame_count(),
            0);
  const auto no_frames = edit({"walk.anim", "-o", "x.anim", "--from", "0"});
  EXPECT_TRUE(test::has_code(no_frames.err, "edit-range")) << no_frames.err;
}

TEST_F(KrokEdit, TakesACaptureAsItIs) {
  put("chain.bvh", capture(40));
  const auto done = edit({"chain.bvh", "-o", "out.anim", "--from", "10f"});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(read("out.anim").frame_count(), 30);
}

TEST_F(KrokEdit, ARoleMapTellsLeftFromRight) {
  Clip clip = walk();
  const Skeleton named = walk().skeleton;
  for (std::size_t j = 0; j < clip.skeleton.names.size(); ++j) {
    clip.skeleton.names[j] = "j" + std::to_string(j);
    // One leg put aside in the reference pose, so that the shape tells nothing either.
    Vec3& place = clip.skeleton.reference[j].position;
    place.y() *= 0.05;
    if (named.names[j] == "LeftUpLeg") place.z() += 0.5;
  }
  write("walk.anim", clip);
  std::string roles;
  for (const auto& [name, role] : {std::pair("Hips", "hips"),
                                   {"LeftUpLeg", "left_upper_leg"},
                                   {"LeftLeg", "left_lower_leg"},
                                   {"LeftFoot", "left_foot"},
                                   {"RightUpLeg", "right_upper_leg"},
                                   {"RightLeg", "right_lower_leg"},
                                   {"RightFoot", "right_foot"}}) {
    roles += (roles.empty() ? "\"j" : ", \"j") + std::to_string(named.find(name)) + "\": \"" +
             role + "\"";
  }
  put("roles.json", "{\"schema\": \"krok.role-map/1\", \"joints\": {" + roles + "}}");
  const auto pairs = [&](const std::vector<std::string>& options) {
    return report_of(options)["result"]["steps"][0]["pairs"].dump();
  };
  const nlohmann::json wanted = {"j" + std::to_string(named.find("LeftLeg")),
                                 "j" + std::to_string(named.find("RightLeg"))};
  EXPECT_THAT(pairs({"--mirror", "--map", "roles.json"}), HasSubstr(wanted.dump()));
  EXPECT_THAT(pairs({"--mirror"}), Not(HasSubstr(wanted.dump())));
}

TEST_F(KrokEdit, ManyAtOnceAndEverySequenceOfEach) {
  write("walk.anim", walk());
  write("other.anim", walk());
  put("take.json", R"({"schema": "krok.sequences/1", "sequences": [
    {"name": "a", "first": 0, "last": 40}, {"name": "b", "first": 50, "last": 60}]})");
  const auto done =
      edit({"walk.anim", "other.anim", "--out-dir", "out", "--sequences", "take.json", "--mirror"});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  for (const char* name : {"out/walk_a.anim", "out/other_a.anim"}) {
    EXPECT_EQ(read(name).frame_count(), 41);
  }
  EXPECT_EQ(read("out/walk_b.anim").frame_count(), 11);
  const auto single =
      edit({"walk.anim", "-o", "x_{sequence}.anim", "--sequences", "take.json", "--json"});
  EXPECT_EQ(single.exit_code, 0) << single.err;
  const auto report = nlohmann::json::parse(single.out);
  EXPECT_EQ(report["outputs"], (nlohmann::json{"x_a.anim", "x_b.anim"}));
  EXPECT_EQ(report["result"]["sequences"][1]["frames"], 11);
  const auto unnamed = edit({"walk.anim", "-o", "x.anim", "--sequences", "take.json"});
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_THAT(unnamed.err, HasSubstr("{sequence}"));
}

TEST_F(KrokEdit, TheSameBytesForAnyNumberOfThreads) {
  write("walk.anim", walk(0.01));
  edited({"--spikes", "--filter", "butterworth", "-j", "1"});
  const std::string one = get(path("out.anim"));
  edited({"--spikes", "--filter", "butterworth", "-j", "4"});
  EXPECT_EQ(get(path("out.anim")), one);
}

}  // namespace
}  // namespace krok::test
