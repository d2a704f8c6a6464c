// If these fail, krok-plot draws something else than its user asked for, or leaves them without
// knowing why there is no figure. What charts show is tested in tests/unit/draw.

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/fixture.h"
#include "cli/kept_files.h"
#include "core/fed_program.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

const std::string kTurn = test::source_folder() + "/samples/captures/turn.bvh";

class KrokPlot : public CliTest {
 protected:
  ToolRun plot(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"-o", path("out.svg"), "--json=" + path("report.json")});
    return run_tool("krok-plot", arguments);
  }
  std::string svg() const { return get(path("out.svg")); }
  json panels() const { return json::parse(get(path("report.json")))["result"]["panels"]; }
  std::vector<std::string> titles() const {
    std::vector<std::string> found;
    for (const json& panel : panels()) found.push_back(panel["title"]);
    return found;
  }
  std::vector<std::string> lines(std::size_t panel) const {
    std::vector<std::string> found;
    const json all = panels();
    for (const json& line : all[panel]["lines"]) found.push_back(line["name"]);
    return found;
  }
  void expect_trouble(std::vector<std::string> arguments, const char* code,
                      const std::string& words) const {
    std::filesystem::remove(path("out.svg"));
    const ToolRun run = plot(std::move(arguments));
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_TRUE(has_code(run.err, code)) << run.err;
    EXPECT_THAT(run.err, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(path("out.svg")));
  }
};

TEST_F(KrokPlot, CyclesAreOfAllTakesAndKeysNeedNotBeThere) {
  ASSERT_EQ(plot({kWalk, kTurn, "--show", "cycles"}).exit_code, 0);
  const json result = json::parse(get(path("report.json")))["result"];
  EXPECT_EQ(result["cycles"]["motions"], 2);
  const int both = result["cycles"]["left"];
  ASSERT_EQ(plot({kWalk, "--show", "cycles"}).exit_code, 0);
  const json alone = json::parse(get(path("report.json")))["result"];
  EXPECT_LT(alone["cycles"]["left"], both);
  EXPECT_THAT(get(path("out.svg")), HasSubstr(alone["cycles"]["left"].dump() + " left and"));
  EXPECT_GE(alone["cycles"]["left"], 1);
  // As numbers: each percent of each angle of both sides, with the deviation of several cycles.
  ASSERT_EQ(
      run_tool("krok-plot", {kWalk, kTurn, "--show", "cycles", "-o", path("cycles.csv")}).exit_code,
      0);
  std::istringstream table(get(path("cycles.csv")));
  std::string row;
  std::getline(table, row);
  EXPECT_EQ(row, "panel,line,x,y,deviation,x_axis,y_axis");
  int rows = 0;
  while (std::getline(table, row)) {
    ++rows;
    EXPECT_THAT(row, HasSubstr("gait cycle"));
    EXPECT_THAT(row, Not(HasSubstr(",,"))) << "no deviation";
  }
  EXPECT_EQ(rows % (2 * 101), 0) << rows;
  EXPECT_GT(rows, 0);
  EXPECT_THAT(titles(), ElementsAre("Hip flexion", "Knee flexion", "Ankle dorsiflexion",
                                    "Shoulder elevation", "Elbow flexion"));
  EXPECT_EQ(alone["panels"][1]["x"]["unit"], "%");
  // Knees of walkers bend by 45 to 70 degrees in swing (Winter 1991).
  EXPECT_GT(alone["panels"][1]["lines"][0]["largest"], 45);
  EXPECT_LT(alone["panels"][1]["lines"][0]["largest"], 75);
  expect_trouble({kWalk, "--show", "cycles", "--to", "0.3s"}, "plot-cycles", "no whole gait cycle");
}

// Would fail if the mean over takes were that of one long take, without a word.
TEST_F(KrokPlot, CyclesMostlyOfOneTakeAreWarnedOf) {
  std::vector<std::string> takes = {kWalk};
  for (const char* name : {"a.anim", "b.anim"}) {
    ASSERT_EQ(run_tool("krok-edit", {kWalk, "--cycle", "left", "-o", path(name), "-q"}).exit_code,
              0);
    takes.push_back(path(name));
  }
  takes.insert(takes.end(), {"--show", "cycles"});
  const ToolRun run = plot(takes);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, testing::ContainsRegex(
                           "[0-9]+ of [0-9]+ gait cycles are of one of 3 motions, .*walk"));
  EXPECT_THAT(plot({kWalk, kTurn, "--show", "cycles"}).err,
              testing::Not(HasSubstr("gait cycles are of one")));
}

// Would fail if one broken file of a folder kept the chart, the sheet or the page from all others.
// A loop has the cycles of its circle. Would fail if clips for engines, cut elsewhere than at a
// strike, were said to have none.
TEST_F(KrokPlot, CyclesOfALoopGoOnOverItsSeam) {
  run_tool("krok-edit",
           {kWalk, "--cycle", "auto", "--loop", "--in-place", "-o", path("loop.anim")});
  ASSERT_EQ(plot({path("loop.anim"), "--show", "cycles"}).exit_code, 0);
  const json cycles = json::parse(get(path("report.json")))["result"]["cycles"];
  EXPECT_EQ(cycles["left"], 1);
  EXPECT_EQ(cycles["right"], 1);
}

TEST_F(KrokPlot, WhatCannotBeReadIsLeftOutWhereThatIsAskedFor) {
  put("broken.bvh", "HIERARCHY nothing");
  const std::vector<std::string> inputs = {kWalk, path("broken.bvh"), kTurn};
  const auto run = [&](const char* tool, std::vector<std::string> options) {
    options.insert(options.begin(), inputs.begin(), inputs.end());
    return run_tool(tool, options);
  };
  for (const auto& [tool, output] :
       {std::pair{"krok-plot",
                  std::vector<std::string>{"--show", "cycles", "-o", path("angles.svg")}},
        {"krok-plot", {"--sheet", path("sheet.png")}},
        {"krok-view", {"-o", path("page.html")}}}) {
    const ToolRun stopped = run(tool, output);
    EXPECT_EQ(stopped.exit_code, 2) << tool;
    EXPECT_THAT(stopped.err, HasSubstr("--keep-going leaves it out")) << tool;
    EXPECT_FALSE(std::filesystem::exists(output.back()));
    std::vector<std::string> going = output;
    going.emplace_back("--keep-going");
    const ToolRun done = run(tool, going);
    EXPECT_EQ(done.exit_code, 3) << tool << done.err;
    EXPECT_THAT(done.err,
                AllOf(HasSubstr("broken.bvh:1:11: warning"), HasSubstr("1 input left out")));
  }
  const ToolRun none = run_tool("krok-plot", {path("broken.bvh"), path("broken.bvh"), "--show",
                                              "cycles", "--keep-going", "-o", path("none.svg")});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_TRUE(has_code(none.err, "inputs-none")) << none.err;
}

TEST_F(KrokPlot, ChartsAreWhatTheirNamesSay) {
  const auto into = [&](const std::string& name, const std::string& folders) {
    return test::run({"/usr/bin/env", "PATH=" + folders, test::tools_folder() + "/krok-plot", kWalk,
                      "--show", "feet", "-o", path(name)});
  };
  const ToolRun without = into("w.pdf", "/nowhere");
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_TRUE(has_code(without.err, "chart-program")) << without.err;
  EXPECT_THAT(without.err, HasSubstr("librsvg2-bin"));
  EXPECT_FALSE(std::filesystem::exists(path("w.pdf")));
  if (!find_program("rsvg-convert")) GTEST_SKIP() << "rsvg-convert is not installed";
  for (const auto& [ending, magic] :
       {std::pair<std::string, std::string>{".pdf", "%PDF"}, {".png", "\x89PNG"}}) {
    for (const std::string name : {"a", "b"}) {
      const ToolRun run = into(name + ending, "/usr/bin:/bin");
      ASSERT_EQ(run.exit_code, 0) << run.err;
      EXPECT_EQ(get(path(name + ending)).substr(0, 4), magic);
    }
    EXPECT_TRUE(get(path("a" + ending)) == get(path("b" + ending))) << ending;
  }
}

TEST_F(KrokPlot, ShowsWhatMattersOfAPersonWithoutOptions) {
  const ToolRun run = plot({kWalk});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("8 panels"));
  EXPECT_THAT(titles(),
              ElementsAre("Path from above, a dot every 0.5 s", "Height of the feet (lowest joint)",
                          "Speed of the feet (slowest joint)", "Hip flexion", "Knee flexion",
                          "Ankle dorsiflexion", "Shoulder elevation", "Elbow flexion"));
  for (const char* text : {">walk.bvh<", ">left<", ">right<", ">time (s)<", ">height (m)<"}) {
    EXPECT_THAT(svg(), HasSubstr(text));
  }
  // The walk is a walk: knees straighten and bend to about 60 degrees, hips swing to both sides
  // (Winter 1991, normal gait: knee 0 to 65, hip -11 to 22 and more for long steps).
  const json shown = panels();
  for (const json& line : shown[4]["lines"]) {
    EXPECT_LT(line["smallest"].get<double>(), 10);
    EXPECT_GT(line["largest"].get<double>(), 50);
    EXPECT_LT(line["largest"].get<double>(), 75);
  }
  for (const json& line : shown[3]["lines"]) {
    EXPECT_LT(line["smallest"].get<double>(), -10);
    EXPECT_GT(line["largest"].get<double>(), 20);
  }
}

TEST_F(KrokPlot, GivesTheSameBytesForAnyJobs) {
  ASSERT_EQ(plot({kWalk, "-j", "1"}).exit_code, 0);
  const std::string first = svg();
  ASSERT_EQ(plot({kWalk, "-j", "4"}).exit_code, 0);
  EXPECT_EQ(svg(), first);
}

TEST_F(KrokPlot, ShowsTheChartsAskedForInTheirOrder) {
  ASSERT_EQ(plot({kWalk, "--show", "positions,path", "--show", "path"}).exit_code, 0);
  EXPECT_THAT(titles(), ElementsAre("Hips", "Path from above, a dot every 0.5 s"));
}

TEST_F(KrokPlot, ShowsAPartOfTheTime) {
  ASSERT_EQ(plot({kWalk, "--show", "positions", "--from", "0.5s", "--to", "60f"}).exit_code, 0);
  EXPECT_EQ(panels()[0]["lines"][0]["values"], 31);  // frames 30 to 60
  expect_trouble({kWalk, "--from", "9s"}, "plot-range", "no frame lies between 9 s");
  expect_trouble({kWalk, "--from", "2s", "--to", "1s"}, "plot-range", "264 frames");
  expect_trouble({kWalk, "--from", "soon"}, "quantity-number", "--from");
}

TEST_F(KrokPlot, ShowsJointsByName) {
  ASSERT_EQ(plot({kWalk, "--joint", "Left*Arm", "--euler", "zxy"}).exit_code, 0);
  const auto shown = titles();
  ASSERT_GE(shown.size(), 4U);
  EXPECT_EQ(shown[0], "LeftArm");
  EXPECT_EQ(shown[2], "LeftArm (ZXY Euler)");
  EXPECT_THAT(lines(2), ElementsAre("z", "x", "y"));
  ASSERT_EQ(plot({kWalk, "--joint", "left_lower_arm"}).exit_code, 0);
  EXPECT_EQ(titles().front(), "LeftForeArm");
  expect_trouble({kWalk, "--joint", "Tail"}, "motion-joint", "Tail");
  expect_trouble({kWalk, "--joint", "Hips", "--euler", "XXY"}, "usage", "--euler");
  expect_trouble({kWalk, "--euler", "XYZ"}, "usage", "--joint");
}

TEST_F(KrokPlot, PutsTwoMotionsIntoTheSamePanels) {
  ASSERT_EQ(plot({kWalk, kTurn}).exit_code, 0);
  EXPECT_THAT(panels(), SizeIs(8));
  EXPECT_THAT(lines(4), ElementsAre("left, walk.bvh", "right, walk.bvh", "left, turn.bvh",
                                    "right, turn.bvh"));
  EXPECT_THAT(svg(), HasSubstr(">turn.bvh<"));
  EXPECT_THAT(svg(), HasSubstr(">walk.bvh and turn.bvh<"));
}

TEST_F(KrokPlot, ShowsHowFarTwoMotionsAreApart) {
  // In frame 1 the whole figure of the second is 2 cm further in z.
  const std::string a = put("a.bvh", capture(20)), b = put("b.bvh", capture(20, "0.02"));
  const ToolRun run = plot({a, b, "--difference"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(titles(), ElementsAre("Distance between joints", "Angle between joints"));
  const json difference = json::parse(get(path("report.json")))["result"]["difference"];
  EXPECT_NEAR(difference["positions"]["largest"].get<double>(), 0.02, 1e-6);
  EXPECT_EQ(difference["positions"]["frame"], 1);
  EXPECT_NEAR(difference["positions"]["rms"].get<double>(), 0.02 / std::sqrt(20), 1e-6);
  EXPECT_EQ(difference["orientations"]["largest"], 0.0);
  expect_trouble({a, "--difference"}, "usage", "needs two motions, not 1");
}

TEST_F(KrokPlot, DrawsContactsThatStandBesideTheMotion) {
  put("walk.bvh", get(kWalk));
  put("walk.keys.json", R"({"schema": "krok.keys/1", "contacts": [
    {"joint": "LeftFoot", "start": 0.6, "end": 1.2, "place": [0.05, 0.07, 0.7]}],
    "keytimes": [{"name": "left_strike", "time": 0.6}]})");
  ASSERT_EQ(plot({path("walk.bvh")}).exit_code, 0);
  EXPECT_THAT(svg(), HasSubstr(">left_strike<"));
  EXPECT_THAT(svg(), HasSubstr("fill-opacity"));
  const std::string with_keys = svg();
  ASSERT_EQ(plot({path("walk.bvh"), "--contacts", "none"}).exit_code, 0);
  EXPECT_THAT(svg(), Not(HasSubstr("left_strike")));
  ASSERT_EQ(plot({kWalk, "--contacts", path("walk.keys.json")}).exit_code, 0);
  EXPECT_EQ(svg(), with_keys);
  put("walk.keys.json", "{\"schema\": 7}");
  expect_trouble({path("walk.bvh")}, "keys-value", "walk.keys.json:1:12");
}

TEST_F(KrokPlot, ShowsAActorThatIsNoPerson) {
  const std::string chain = put("chain.bvh", capture(30));
  ASSERT_EQ(plot({chain}).exit_code, 0);
  EXPECT_THAT(titles(), ElementsAre("Path from above, a dot every 0.1 s", "Hips",
                                    "Rotation from the reference pose"));
  const ToolRun run = plot({chain, "--show", "feet,path"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("no joint has a role for the feet"));
  expect_trouble({chain, "--show", "feet"}, "plot-roles", "--map");
}

TEST_F(KrokPlot, ShowsOneFrame) {
  ASSERT_EQ(plot({put("one.bvh", capture(1))}).exit_code, 0);
  EXPECT_THAT(svg(), Not(HasSubstr("nan")));
  EXPECT_THAT(svg(), Not(HasSubstr("inf")));
}

TEST_F(KrokPlot, DrawsTheTableThatKrokExportWrites) {
  ASSERT_EQ(run_tool("krok-export", {kWalk, "-o", path("walk.csv")}).exit_code, 0);
  const ToolRun run = plot(
      {path("walk.csv"), "--where", "joint=LeftFoot", "--where", "joint=RightFoot", "--y", "y"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(lines(0), ElementsAre("LeftFoot", "RightFoot"));
  EXPECT_EQ(panels()[0]["x"], (json{{"label", "time"}, {"unit", "s"}}));
  EXPECT_EQ(panels()[0]["y"], (json{{"label", "y"}, {"unit", "m"}}));
  EXPECT_THAT(svg(), HasSubstr(">time (s)<"));
  EXPECT_EQ(panels()[0]["lines"][0]["values"], 264);
  const json from_table = panels()[0]["lines"][0];
  ASSERT_EQ(plot({kWalk, "--show", "positions", "--joint", "LeftFoot"}).exit_code, 0);
  EXPECT_NEAR(panels()[0]["lines"][1]["smallest"].get<double>(),
              from_table["smallest"].get<double>(), 1e-6);
  EXPECT_NEAR(panels()[0]["lines"][1]["largest"].get<double>(), from_table["largest"].get<double>(),
              1e-6);
}

TEST_F(KrokPlot, DrawsATableByColumnNames) {
  const std::string table =
      put("fit.csv", "examples,error_mm,size_mm,cost [s]\n1,100,2,0.5\n10,1,4,\n100,0.01,8,3\n");
  ASSERT_EQ(plot({table, "-v"}).exit_code, 0);
  EXPECT_THAT(panels(), SizeIs(2));  // a panel for millimetres, one for seconds
  EXPECT_THAT(lines(0), ElementsAre("error", "size"));
  ASSERT_EQ(plot({table, "--x", "examples", "--y", "error", "--y", "size,cost", "--log-x",
                  "--log-y", "--draw", "both"})
                .exit_code,
            0);
  EXPECT_THAT(lines(1), ElementsAre("size", "cost"));
  EXPECT_EQ(panels()[1]["lines"][1]["values"], 2);  // and a gap
  EXPECT_THAT(svg(), HasSubstr(">error (mm)<"));
  EXPECT_THAT(svg(), HasSubstr(">0.01<"));
  EXPECT_THAT(svg(), HasSubstr("<circle"));
}

// Would fail if a line went from the end of one file, or angle, to the start of the next.
TEST_F(KrokPlot, ATableOfSeveralFilesAndAnglesHasALineForEach) {
  const std::string table = put("all.csv",
                                "file,time,angle,value\na,0,knee,1\na,0,hip,2\na,1,knee,3\n"
                                "a,1,hip,4\nb,0,knee,5\nb,0,hip,6\nb,1,knee,7\nb,1,hip,8\n");
  ASSERT_EQ(plot({table}).exit_code, 0);
  EXPECT_THAT(lines(0), ElementsAre("a knee", "a hip", "b knee", "b hip"));
  ASSERT_EQ(plot({table, "--where", "angle=knee"}).exit_code, 0);
  EXPECT_THAT(lines(0), ElementsAre("a", "b"));
}

TEST_F(KrokPlot, ATableOfOpenSimBeginsAfterItsHeader) {
  const std::string table = put("a.sto", "angles\nversion=1\nendheader\ntime\tknee\n0\t1\n1\t9\n");
  ASSERT_EQ(plot({table}).exit_code, 0);
  EXPECT_EQ(panels()[0]["lines"][0]["largest"], 9.0);
}

TEST_F(KrokPlot, TakesATableOfAnyNameWhereItIsTold) {
  const std::string table = put("numbers.dat", "1;2\n2;4\n3;6\n");
  ASSERT_EQ(plot({"--as-table", table}).exit_code, 0);
  EXPECT_THAT(lines(0), ElementsAre("column 2"));
  EXPECT_EQ(panels()[0]["lines"][0]["largest"], 6.0);
}

TEST_F(KrokPlot, SaysWhatIsWrongWithATable) {
  const std::string ragged = put("ragged.csv", "a,b\n1,2\n3\n");
  expect_trouble({ragged}, "csv-ragged", "ragged.csv:3:1: error: 1 cell here, 2 columns");
  const std::string words = put("words.csv", "t,v\n0,1\n1,fast\n");
  expect_trouble({words, "--y", "v"}, "csv-number",
                 "words.csv:3:3: error: 'fast' in the column 'v'");
  expect_trouble({words, "--y", "w"}, "csv-column", "columns are t, v");
  expect_trouble({words, "--y", "t", "--where", "v=slow"}, "plot-where", "no v is 'slow'");
  expect_trouble({words, "--where", "v"}, "usage", "joint=Hips");
  expect_trouble({put("empty.csv", "")}, "csv-empty", "empty.csv");
  expect_trouble({words, "--joint", "Hips"}, "usage", "--joint is for motions");
  expect_trouble({kWalk, "--y", "v"}, "usage", "--y is for tables");
  expect_trouble({kWalk, words}, "usage", "cannot share a chart");
  std::string wide = "a";
  for (int i = 0; i < 100; ++i) wide += ",b" + std::to_string(i);
  wide += "\n1";
  for (int i = 0; i < 100; ++i) wide += ",1";
  expect_trouble({put("wide.csv", wide)}, "plot-lines", "--y selects columns");
}

TEST_F(KrokPlot, RefusesNamesOfOtherKindsOfFiles) {
  const ToolRun run = run_tool("krok-plot", {kWalk, "-o", path("out.xlsx")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr(".svg"));
  EXPECT_THAT(listing(), IsEmpty());
}

TEST_F(KrokPlot, WithoutAnOutputTheChartIsBesideTheInput) {
  std::filesystem::copy_file(kWalk, path("take.bvh"));
  ASSERT_EQ(run_tool("krok-plot", {path("take.bvh")}).exit_code, 0);
  EXPECT_THAT(listing(), testing::ElementsAre("take.bvh", "take.svg"));
}

TEST_F(KrokPlot, FitsThePaper) {
  ASSERT_EQ(plot({kWalk, "--columns", "1", "--panel", "400x100", "--title", "A & B"}).exit_code, 0);
  EXPECT_THAT(svg(), HasSubstr("width=\"482\""));
  EXPECT_THAT(svg(), HasSubstr(">A &amp; B<"));
  expect_trouble({kWalk, "--panel", "400"}, "usage", "340x170");
  expect_trouble({kWalk, "--panel", "0x100"}, "usage", "340x170");
  expect_trouble({kWalk, "--show", "toes"}, "usage", "'toes' is not path, feet");
  expect_trouble({kWalk, "--moments", "3"}, "usage", "for --sheet or --strip");
}

TEST_F(KrokPlot, MakesAFileOfEachOfMany) {
  put("a.bvh", capture(5));
  put("b.bvh", capture(6));
  const ToolRun run = run_tool(
      "krok-plot", {path("a.bvh"), path("b.bvh"), "--show", "path", "--out-dir", path("plots")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(get(path("plots/a.svg")), HasSubstr(">a.bvh<"));
  EXPECT_THAT(get(path("plots/b.svg")), HasSubstr(">b.bvh<"));
}

}  // namespace
}  // namespace krok::test
