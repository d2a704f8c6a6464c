// If these fail, krok-fit or krok-synth leave their user with a library that was made of other
// motions than it says, a step that is not what was asked for, or without knowing why there is
// none.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/step_library/library_fixture.h"
#include "formats/steps/steps.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST_F(StepLibrary, MakesWhatIsAskedForAndTellsWhatItMeasures) {
  fit_well();
  const json made = synthesised({"--set", "length=60cm", "--set", "height=0.04"});
  ASSERT_EQ(made.size(), 1u);
  EXPECT_EQ(made[0]["asked"]["length"], 0.6);
  EXPECT_NEAR(made[0]["measured"]["length"].get<double>(), 0.6, 1e-3);
  EXPECT_NEAR(made[0]["measured"]["height"].get<double>(), 0.04, 1e-3);
  double sum = 0;
  for (const json& weight : made[0]["weights"]) sum += weight.get<double>();
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_THAT(listing(), Contains("step.anim"));
  EXPECT_THAT(listing(), Contains("step.keys.json"));
}

TEST_F(StepLibrary, CorrectingComesNearer) {
  fit_well({"--refine", "0"});
  const std::vector<std::string> set = {"--set", "length=61cm", "--set", "step.height=3cm"};
  std::vector<std::string> correct = set;
  correct.emplace_back("--correct");
  const json plain = synthesised(set), corrected = synthesised(correct);
  const double error = std::abs(corrected[0]["measured"]["length"].get<double>() - 0.61);
  EXPECT_LT(error, 1e-4);
  EXPECT_LE(corrected[0]["error_in_tolerances"].get<double>(),
            plain[0]["error_in_tolerances"].get<double>());
}

TEST_F(StepLibrary, TheOtherSideIsTheMirrorImage) {
  fit_well();
  const std::vector<std::string> set = {"--set", "length=60cm", "--set", "height=2cm"};
  const json left = synthesised(set);
  std::vector<std::string> right = set;
  right.insert(right.end(), {"--side", "right", "-o", path("right.anim")});
  const json other = synthesised(right);
  EXPECT_NEAR(left[0]["measured"]["length"].get<double>(),
              other[0]["measured"]["length"].get<double>(), 1e-6);
  // Mirrored back it is the same motion.
  const ToolRun mirrored =
      run_tool("krok-edit", {path("right.anim"), "--mirror", "-o", path("back.anim"), "-q"});
  ASSERT_EQ(mirrored.exit_code, 0) << mirrored.err;
  const ToolRun diff =
      run_tool("krok-diff", {path("step.anim"), path("back.anim"), "--tolerance", "1mm"});
  EXPECT_EQ(diff.exit_code, 0) << diff.out << diff.err;
}

TEST_F(StepLibrary, OutsideTheExamplesIsRefusedWithTheNearestInside) {
  fit_well();
  const ToolRun refused = synth({"--set", "length=1.2m", "--set", "height=0"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(has_code(refused.err, "parametric-bounds")) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("nearest"));
  EXPECT_THAT(refused.err, HasSubstr("--extrapolate"));
  EXPECT_THAT(listing(), Not(Contains("step.anim")));
  const ToolRun beyond = synth({"--set", "length=0.75m", "--set", "height=0", "--extrapolate"});
  EXPECT_EQ(beyond.exit_code, 0) << beyond.err;
}

TEST_F(StepLibrary, WhatIsAskedWronglyIsToldWithWhatTheLibraryTakes) {
  fit_well();
  const std::pair<std::vector<std::string>, const char*> mistakes[] = {
      {{"--set", "width=60cm"}, "unknown parameter 'width'"},
      {{"--set", "length"}, "NAME=VALUE"},
      {{"--set", "length=1m", "--set", "length=2m"}, "twice"},
      {{"--set", "length=60deg", "--set", "height=0"}, "'deg'"}};
  for (const auto& [arguments, says] : mistakes) {
    const ToolRun run = synth(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr(says));
  }
}

// Would fail if a parameter that nobody gave had another value than the one that is printed.
// Would fail if a file were printed as made that could not be written.
TEST_F(StepLibrary, AFileThatIsNotWrittenIsNotPrinted) {
  fit_well();
  write("points.csv", "length,height\n0.55,0.02\n0.6,0.02\n");
  const ToolRun all = synth({"--points", path("points.csv"), "--in-sequence"});
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.err, testing::Not(testing::HasSubstr("step_1.anim")));
  EXPECT_THAT(all.err, testing::HasSubstr("step.anim: 2 motions, "));
  const ToolRun run = synth({"-o", path("none/step.anim")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, testing::Not(testing::HasSubstr("step.anim: 0.")));
  EXPECT_THAT(run.err, testing::HasSubstr("error: "));
}

TEST_F(StepLibrary, ParametersThatAreNotGivenAreTheMean) {
  fit_well();
  const ToolRun run = synth({"--set", "height=0", "-o", path("mean.anim")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::size_t at = run.err.find("length: ");
  ASSERT_NE(at, std::string::npos) << run.err;
  const std::string length = run.err.substr(at + 8, run.err.find(" m,", at) - at - 8);
  const json made = synthesised({"--set", "length=" + length + "m", "--set", "height=0"});
  const json mean = synthesised({"--set", "height=0"});
  EXPECT_NEAR(mean[0]["asked"]["length"], made[0]["asked"]["length"], 1e-3);
}

TEST_F(StepLibrary, ATableMakesAMotionForEachRow) {
  fit_well();
  write("points.csv", "height [cm],length\n0,0.55\n4,0.6\n8,0.65\n");
  const json made = synthesised({"--points", path("points.csv"), "-o", path("s.anim")});
  ASSERT_EQ(made.size(), 3u);
  EXPECT_NEAR(made[2]["measured"]["height"].get<double>(), 0.08, 1e-3);
  EXPECT_NEAR(made[0]["measured"]["length"].get<double>(), 0.55, 1e-3);
  for (const char* name : {"s_1.anim", "s_2.anim", "s_3.anim"}) {
    EXPECT_THAT(listing(), Contains(name));
  }
  write("points.csv", "height,length\n0,0.55\n0,9\n");
  const ToolRun outside = synth({"--points", path("points.csv"), "-o", path("t.anim")});
  EXPECT_EQ(outside.exit_code, 2);
  EXPECT_THAT(outside.err, HasSubstr("row 2"));
  EXPECT_THAT(listing(), Not(Contains("t_1.anim")));
}

// What was made is measured, not what the weights promise.
// The figures of the fit, before the files that it was made of.
TEST_F(StepLibrary, TheSameBytesWhateverTheThreads) {
  fit_well({"--refine", "12", "--max-error", "0.001mm", "-j", "1"});
  const auto first = InputFile::open(path("out.steps"));
  ASSERT_TRUE(first.ok());
  const std::string bytes(first->text());
  fit_well({"--refine", "12", "--max-error", "0.001mm", "-j", "2"});
  EXPECT_TRUE(bytes == InputFile::open(path("out.steps"))->text());
}

// The weights of a library that was stopped at the end of a round (2 + 4 points here) and continued
// are those of one made in one go: the same steps come out of both.
TEST_F(StepLibrary, GoingOnIsAsIfItHadNotStopped) {
  fit_well({"--refine", "16", "--max-error", "0.001mm"});
  const std::vector<std::string> set = {"--set", "length=57cm", "--set", "height=5cm"};
  const json whole = synthesised(set);
  fit_well({"--refine", "6", "--max-error", "0.001mm"});
  const ToolRun moved = run({"/bin/mv", path("out.steps"), path("half.steps")});
  ASSERT_EQ(moved.exit_code, 0);
  fit_well({"--refine", "16", "--max-error", "0.001mm", "--resume", path("half.steps")});
  EXPECT_EQ(synthesised(set)[0]["weights"], whole[0]["weights"]);
}

// The errors before and after polishing are told, and going on, with and without, starts from what
// was found.
TEST_F(StepLibrary, InsertedWeightsArePolishedUnlessToldNotTo) {
  const std::vector<std::string> set = {"--set", "length=57cm", "--set", "height=5cm"};
  const auto fitted = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--refine", "16", "--max-error", "0.001mm", "--json"});
    describe();
    const ToolRun run = fit(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? json::parse(run.out)["result"] : json();
  };
  const json plain = fitted({"--no-polish"});
  const json plain_step = synthesised(set);
  EXPECT_FALSE(plain.contains("polished"));
  const json polished = fitted({});
  ASSERT_TRUE(polished.contains("polished"));
  EXPECT_EQ(polished["rounds"], plain["rounds"]);
  const json found = polished["rounds"].back()["after"], after = polished["polished"]["after"];
  EXPECT_LT(after["mean_square_of_range"], found["mean_square_of_range"]);
  EXPECT_LE(after["largest_of_range"], found["largest_of_range"]);
  EXPECT_NE(synthesised(set)[0]["weights"], plain_step[0]["weights"]);
  ASSERT_EQ(run({"/bin/mv", path("out.steps"), path("polished.steps")}).exit_code, 0);
  const json again = fitted({"--no-polish", "--resume", path("polished.steps")});
  EXPECT_FALSE(again.contains("polished"));
  EXPECT_EQ(again["rounds"], plain["rounds"]);
  EXPECT_EQ(synthesised(set)[0]["weights"], plain_step[0]["weights"]);
}

TEST_F(StepLibrary, TheErrorsBeforePolishingAreSaid) {
  describe();
  const ToolRun run = fit({"--refine", "16", "--max-error", "0.001mm"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out + run.err, HasSubstr("polished together; before that, errors were "));
}

// A report that does not fit the points is not believed: each point would take time.
TEST_F(StepLibrary, ALibraryWithOtherPointsThanItSaysIsNotGoneOnWith) {
  fit_well({"--refine", "8", "--max-error", "0.001mm"});
  const auto bytes = InputFile::open(path("out.steps"));
  const auto whole = steps::read(bytes->bytes());
  ASSERT_TRUE(whole.ok());
  const auto fit_forged = [&](const auto& forge) {
    steps::StepsFile file = *whole;
    json report = json::parse(file.report);
    forge(report);
    file.report = report.dump();
    auto out = OutputFile::create(path("forged.steps"));
    EXPECT_TRUE(steps::write(file, {}, *out).ok() && out->commit().ok());
    return fit({"--resume", path("forged.steps")});
  };
  EXPECT_EQ(fit_forged([](json&) {}).exit_code, 0);
  for (const auto& forge : std::initializer_list<void (*)(json&)>{
           [](json& report) { report["rounds"][0]["inserted"] = 1; },
           [](json& report) { report["rounds"][0]["inserted"] = -1; },
           [](json& report) {  // as many, but more than a round inserts
             report["rounds"] = nlohmann::json::array({report["rounds"][0]});
             report["rounds"][0]["inserted"] = report["inserted"];
           },
           [](json& report) { report["rounds"][0]["refused"] = 1; },
           [](json& report) { report["polished"]["found_rows"].push_back(0.5); },
           [](json& report) { report["polished"].erase("found_rows"); }}) {
    const ToolRun run = fit_forged(forge);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_TRUE(has_code(run.err, "fit-resume")) << run.err;
    EXPECT_THAT(run.err, HasSubstr("forged.steps: error"));
  }
}

TEST_F(StepLibrary, ALibraryOfOtherExamplesIsNotGoneOnWith) {
  fit_well({"--refine", "4"});
  ASSERT_EQ(run({"/bin/mv", path("out.steps"), path("half.steps")}).exit_code, 0);
  describe(R"("examples": [{"clip": "walk_*.bvh"}], "spacing": 0)");
  const ToolRun other = fit({"--resume", path("half.steps")});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_TRUE(has_code(other.err, "fit-resume")) << other.err;
}

// A motion of another skeleton is refused by name, or left out where that is asked for.
TEST_F(StepLibrary, AnotherSkeletonIsRefused) {
  write("walk_odd.bvh", capture(40));
  describe();
  const ToolRun refused = fit();
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("walk_odd.bvh: error"));
  EXPECT_TRUE(has_code(refused.err, "parametric-skeleton")) << refused.err;
  EXPECT_THAT(listing(), Not(Contains("out.steps")));
  const ToolRun partly = fit({"--keep-going"});
  EXPECT_EQ(partly.exit_code, 3) << partly.err;
  EXPECT_THAT(partly.err, HasSubstr("walk_odd.bvh: warning"));
  EXPECT_THAT(listing(), Contains("out.steps"));
}

TEST_F(StepLibrary, MistakesInTheDescriptionHaveTheirPlace) {
  const std::pair<const char*, const char*> mistakes[] = {
      {R"("examples": [{"clip": "none_*.bvh"}])", "library.json:3:15: error: no file matches"},
      {R"("examples": [{"clip": "walk_50_0.bvh"}])", "2 examples for 2 parameters"},
      {R"("examples": [{"clip": "walk_*.bvh"}], "keytimes": ["a", "b"])", "library-keytimes"},
      {R"("examples": [{"clip": "nothere.bvh"}])", "nothere.bvh: error: no such file"}};
  for (const auto& [more, says] : mistakes) {
    describe(more);
    const ToolRun run = fit();
    EXPECT_EQ(run.exit_code, 2) << more;
    EXPECT_THAT(run.err, HasSubstr(says));
    EXPECT_THAT(listing(), Not(Contains("out.steps")));
  }
  write("library.json", R"({"schema": "krok.library/1", "parameters": [{"measures": "step.size"}],
 "examples": [{"clip": "walk_50_0.bvh", "from": "0s", "to": "1s"}]})");
  const ToolRun unknown = fit();
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("library.json:1:45: error"));
}

// Examples given one by one, with keytimes of their own: the height of a hand at a moment.
TEST_F(StepLibrary, OtherMotionsThanStepsWork) {
  write("library.json", R"({"schema": "krok.library/1", "keytimes": ["begin", "middle", "end"],
 "parameters": [{"name": "reach", "measures": "LeftHand.along@middle"}],
 "examples": [
  {"clip": "walk_50_0.bvh", "keytimes": {"begin": 0, "middle": "0.4s", "end": "0.8s"}},
  {"clip": "walk_70_0.bvh", "keytimes": {"begin": 0, "middle": "0.4s", "end": "0.8s"}}]})");
  const ToolRun run = fit();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const ToolRun asked = synth({"--set", "reach=9m"});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_TRUE(has_code(asked.err, "parametric-bounds")) << asked.err;
}

// Generated steps agree: nothing is smoothed unless it is asked for. --report is another name of
// --json=FILE.
TEST_F(StepLibrary, WeightsAreSmoothedWhereItIsAskedFor) {
  const auto report = [&] {
    return json::parse(InputFile::open(path("r.json"))->text())["result"];
  };
  describe();
  for (const std::vector<std::string>& unsmoothed :
       {std::vector<std::string>(), {"--smoothing", "auto"}, {"--smoothing", "0"}}) {
    std::vector<std::string> arguments = {"--report", path("r.json")};
    arguments.insert(arguments.end(), unsmoothed.begin(), unsmoothed.end());
    const ToolRun run = fit(arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_FALSE(has_code(run.err, "fit-contradictions")) << run.err;
    EXPECT_EQ(report()["smoothing"], 0);
  }
  fit_well({"--smoothing", "0.1", "--report", path("r.json")});
  EXPECT_EQ(report()["smoothing"], 0.1);
  EXPECT_GT(report()["example_distance"], 0);
  // Going on does not lose it.
  ASSERT_EQ(run({"/bin/mv", path("out.steps"), path("half.steps")}).exit_code, 0);
  fit_well({"--resume", path("half.steps"), "--refine", "90", "--report", path("r.json")});
  EXPECT_EQ(report()["smoothing"], 0.1);
  for (const char* odd : {"-1", "much", "nan", ""}) {
    EXPECT_EQ(fit({"--smoothing", odd}).exit_code, 2) << odd;
  }
}

// Steps alike in length and duration but not in width: weights that meet them all are so wild that
// nothing can be inserted. Exit code 0 alone would mean that the tolerance is met.
TEST_F(StepLibrary, SaysWhyRefinementCouldNotGoOn) {
  for (int seed = 1; seed <= 8; ++seed) {
    const ToolRun made = run({test::make_walk(),
                              "--steps",
                              "6",
                              "--step-length",
                              std::to_string(50 + 4 * seed) + "cm",
                              "--cadence",
                              seed % 2 == 0 ? "90" : "115",
                              "--step-width",
                              std::to_string(6 + seed * 7 % 15) + "cm",
                              "--rate",
                              "30",
                              "--noise-angle",
                              "0.2deg",
                              "--noise-position",
                              "0.5mm",
                              "--seed",
                              std::to_string(seed),
                              "-q",
                              "-o",
                              path("noisy_" + std::to_string(seed) + ".bvh")});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  write("library.json", R"({"schema": "krok.library/1", "steps": "auto", "spacing": 0,
 "parameters": [{"measures": "step.length"}, {"measures": "duration"}],
 "examples": [{"clip": "noisy_*.bvh"}]})");
  const ToolRun wild = fit({"--kernel", "cubic", "--smoothing", "0"});
  ASSERT_EQ(wild.exit_code, 0) << wild.err;
  EXPECT_TRUE(has_code(wild.err, "fit-stalled")) << wild.err;
  EXPECT_THAT(wild.err, HasSubstr("weights"));
  // Averaged they are not.
  const ToolRun smooth = fit();
  ASSERT_EQ(smooth.exit_code, 0) << smooth.err;
  EXPECT_FALSE(has_code(smooth.err, "fit-stalled")) << smooth.err;
}

TEST_F(StepLibrary, AFileThatIsNoLibraryIsRefused) {
  write("out.steps", "HIERARCHY\n");
  const ToolRun run = synth({"--set", "length=1m"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("out.steps: error"));
}

TEST_F(StepLibrary, ChartsAreWritten) {
  fit_well({"--plot", path("charts")});
  for (const char* name : {"errors.svg", "weights.svg", "parameters.svg", "measured.svg"}) {
    const auto file = InputFile::open(path(std::string("charts/") + name));
    ASSERT_TRUE(file.ok()) << name;
    EXPECT_THAT(std::string(file->text()), HasSubstr("</svg>"));
    EXPECT_THAT(std::string(file->text()), Not(HasSubstr("nan")));
  }
}

// A folder of walks needs no description: its library is the one by length and, where they turn, by
// turn, of both feet; files may be called as patterns are.
TEST_F(StepLibrary, AFolderOfWalksNeedsNoDescription) {
  const auto fitted = [&](const std::string& name) {
    const ToolRun run = run_tool("krok-fit", {path("walks"), "-o", path(name), "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? json::parse(run.out)["result"] : json();
  };
  std::filesystem::create_directory(path("walks"));
  for (const char* length : {"50", "60", "70"}) {
    make_walk(length, "0");
    std::filesystem::rename(path("walk_" + std::string(length) + "_0.bvh"),
                            path("walks/" + std::string(length) + ".bvh"));
  }
  write("walks/notes.txt", "not a motion");
  const json straight = fitted("straight.steps");
  ASSERT_EQ(straight["parameters"].size(), 1u);
  EXPECT_NEAR(straight["parameters"][0]["from"].get<double>(), 0.5, 0.02);
  EXPECT_NEAR(straight["parameters"][0]["to"].get<double>(), 0.7, 0.02);
  for (const char* turn : {"-15", "15"}) {
    const ToolRun made =
        run({test::make_walk(), "--steps", "4", "--turn", std::string(turn) + "deg", "-q", "-o",
             path("walks/bend[" + std::string(turn) + "].bvh")});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  const json bent = fitted("bent.steps");
  ASSERT_EQ(bent["parameters"].size(), 2u);
  EXPECT_EQ(bent["parameters"][1]["name"], "turn");
  EXPECT_TRUE(
      std::ranges::any_of(bent["examples"], [](const json& e) { return e["mirrored"] == true; }));
}

// So does a folder of runs, whose feet are off before the other ones strike.
TEST_F(StepLibrary, AFolderOfRunsNeedsNoDescription) {
  std::filesystem::create_directory(path("runs"));
  for (const std::string length : {"70", "80", "90"}) {
    make_walk(length, "0");
    std::filesystem::rename(path("walk_" + length + "_0.bvh"), path("runs/" + length + ".bvh"));
    const std::string beside = path("runs/" + length + ".keys.json");
    ASSERT_EQ(run_tool("krok-keys", {path("runs/" + length + ".bvh"), "-o", beside}).exit_code, 0);
    json keys = json::parse(get(beside));
    std::vector<json> times;
    for (json key : keys["keytimes"]) {
      if (key["name"].get<std::string>().ends_with("_off")) {
        key["time"] = key["time"].get<double>() - 0.2;
      }
      if (key["time"] > 0.0) times.push_back(key);
    }
    std::ranges::sort(times, {}, [](const json& key) { return key["time"].get<double>(); });
    keys["keytimes"] = times;
    write("runs/" + length + ".keys.json", keys.dump());
  }
  // A walk among them does not make walks of them all.
  make_walk("60", "0");
  std::filesystem::rename(path("walk_60_0.bvh"), path("runs/60.bvh"));
  const ToolRun fitted = run_tool("krok-fit", {path("runs"), "-o", path("runs.steps"), "--json"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  const json info = json::parse(run_tool("krok-info", {path("runs.steps"), "--json"}).out);
  EXPECT_EQ(info["result"]["files"][0]["keytimes"],
            json::parse(R"(["stance_strike", "stance_off", "swing_strike"])"));
}

// Would fail if weights were shown of the first nine examples only.
TEST_F(StepLibrary, WeightsOfAllExamplesAreShown) {
  for (const char* length : {"50", "57", "64", "70"}) {
    for (const char* rise : {"0", "4", "8"}) make_walk(length, rise);
  }
  describe();
  const ToolRun run = fit({"--plot", path("charts"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto count = json::parse(run.out)["result"]["examples"].size();
  ASSERT_GT(count, 9u);
  const std::string chart = get(path("charts/weights.svg"));
  std::size_t panels = 0;
  for (auto at = chart.find(">length (m)<"); at != std::string::npos;
       at = chart.find(">length (m)<", at + 1)) {
    ++panels;
  }
  EXPECT_EQ(panels, count);
}

}  // namespace
}  // namespace krok::test
