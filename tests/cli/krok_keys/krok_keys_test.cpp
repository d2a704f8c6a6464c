// If these fail, krok-keys loses what a person set by hand, writes where it was not told to, or
// leaves its user without knowing what is wrong.

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/fixture.h"
#include "cli/kept_files.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class KrokKeys : public CliTest {
 protected:
  KrokKeys() : motion_(put("walk.bvh", get(kWalk))), file_(path("walk.keys.json")) {}

  ToolRun keys(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), motion_);
    return run_tool("krok-keys", arguments);
  }
  json written() const { return json::parse(get(file_)); }
  void write(const json& text) const { put("walk.keys.json", text.dump(1)); }
  static double time_of(const json& file, const std::string& name, std::size_t which = 0) {
    for (const json& key : file["keytimes"]) {
      if (key["name"] == name && which-- == 0) return key["time"];
    }
    return -1;
  }

  std::string motion_, file_;
};

TEST_F(KrokKeys, FindsTheSamplesKnownEvents) {
  ASSERT_EQ(keys({"-o", file_}).exit_code, 0);
  const json truth =
      json::parse(get(test::source_folder() + "/samples/captures/walk.contacts.json"));
  std::size_t events = 0;
  for (const auto& [name, times] : truth["keytimes"].items()) {
    for (std::size_t i = 0; i < times.size(); ++i, ++events) {
      EXPECT_NEAR(time_of(written(), name, i), times[i].get<double>(), 1.0 / 60) << name << i;
    }
  }
  EXPECT_EQ(written()["keytimes"].size(), events);
  EXPECT_EQ(events, 17U);
}

TEST_F(KrokKeys, ShowsATableAndWritesNothing) {
  const ToolRun run = keys({});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("left_strike"));
  EXPECT_THAT(run.out, HasSubstr("LeftToeBase at "));
  EXPECT_THAT(run.err, HasSubstr("17 keytimes"));
  EXPECT_THAT(listing(), ElementsAre("walk.bvh"));
}

TEST_F(KrokKeys, ReportsAsJson) {
  const ToolRun run = keys({"--json"});
  ASSERT_EQ(run.exit_code, 0);
  const json result = json::parse(run.out)["result"];
  EXPECT_EQ(result["keytimes"].size(), 17U);
  EXPECT_FALSE(result["edited"].get<bool>());
  EXPECT_NEAR(result["gait"]["cadence"].get<double>(), 109.4, 1);
  EXPECT_NEAR(result["gait"]["stance"][0].get<double>(), 0.62, 0.02);
  EXPECT_LT(result["gait"]["slide_speed"].get<double>(), 0.005);
}

// Would fail if the table said something else than the report of one motion, or if one that cannot
// be read took the others with it.
TEST_F(KrokKeys, TheTableHasARowForEachMotion) {
  std::filesystem::create_directory(path("takes"));
  std::filesystem::copy_file(motion_, path("takes/a, b.bvh"));
  std::filesystem::copy_file(motion_, path("takes/c.bvh"));
  const std::string table = path("gait.csv");
  ASSERT_EQ(run_tool("krok-keys", {path("takes"), "--table", table}).exit_code, 0);
  const json gait = json::parse(keys({"--json"}).out)["result"]["gait"];
  const std::string text = get(table);
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 3U) << text;
  EXPECT_THAT(lines[0], testing::StartsWith("file,duration [s],cycles,steps,speed [m/s],cadence"));
  EXPECT_THAT(lines[1], testing::StartsWith('"' + path("takes/a, b.bvh") + "\","));
  std::vector<double> values;
  EXPECT_THAT(lines[2], testing::EndsWith(",walk"));
  std::istringstream row(
      lines[2].substr(lines[2].find(',') + 1, lines[2].rfind(',') - lines[2].find(',') - 1));
  for (std::string cell; std::getline(row, cell, ',');) values.push_back(std::stod(cell));
  ASSERT_EQ(values.size(), 13U) << lines[2];
  EXPECT_EQ(values[1], gait["cycles"]);
  EXPECT_EQ(values[2], gait["steps"]);
  EXPECT_NEAR(values[3], gait["speed"].get<double>(), 1e-3);
  EXPECT_NEAR(values[4], gait["cadence"].get<double>(), 0.1);
  EXPECT_NEAR(values[5], gait["stride_length"].get<double>(), 1e-3);
  EXPECT_NEAR(values[7], gait["step_length"][1].get<double>(), 1e-3);
  EXPECT_NEAR(values[10], 100 * gait["stance"][1].get<double>(), 0.1);
  EXPECT_NEAR(values[12], 1000 * gait["slide_speed"].get<double>(), 0.1);
  put("takes/broken.bvh", "HIERARCHY");
  const ToolRun part = run_tool("krok-keys", {path("takes"), "--table", table});
  EXPECT_EQ(part.exit_code, 3) << part.err;
  EXPECT_EQ(get(table), text);
}

// A walk that goes back to where it began every two metres. Would fail if strides led across that
// (0.005 m/s), or nobody were warned of it.
TEST_F(KrokKeys, PathsThatGoBackToTheirStartAreWarnedOf) {
  std::istringstream walk(get(motion_));
  std::string wrapped, line;
  bool frames = false;
  for (double start = 0, at = 0; std::getline(walk, line); wrapped += line + "\n") {
    std::istringstream numbers(line);
    std::string x, y, z, rest;
    if (frames && numbers >> x >> y >> z) {
      std::getline(numbers, rest);
      at = std::stod(z);
      if (start == 0) start = at;
      line = x + " " + y + " " + std::to_string(start + std::fmod(at - start, 200)) + rest;
    }
    frames = frames || line.starts_with("Frame Time");
  }
  const std::string table = path("gait.csv");
  const ToolRun plain = run_tool("krok-keys", {motion_, "--json"});
  const ToolRun run = run_tool("krok-keys", {put("wrapped.bvh", wrapped), "--json"});
  EXPECT_THAT(plain.err, testing::Not(HasSubstr("keys-jump")));
  EXPECT_THAT(run.err, HasSubstr("keys-jump"));
  const auto gait = [](const ToolRun& made) { return json::parse(made.out)["result"]["gait"]; };
  for (const char* name : {"speed", "stride_length"}) {
    const double right = gait(plain)[name];
    EXPECT_NEAR(gait(run)[name].get<double>(), right, 0.1 * right) << name;
  }
  EXPECT_LT(gait(run)["slide_speed"].get<double>(), 0.02);
  EXPECT_THAT(run_tool("krok-keys", {path("wrapped.bvh"), "--table", table}).err,
              HasSubstr("keys-jump"));
}

// Would fail if the events of a spreadsheet were not those of the report, or got under another
// motion's name.
TEST_F(KrokKeys, EventsAsATable) {
  std::filesystem::create_directory(path("takes"));
  std::filesystem::copy_file(motion_, path("takes/a.bvh"));
  std::filesystem::copy_file(motion_, path("takes/b.bvh"));
  ASSERT_EQ(run_tool("krok-keys", {path("takes"), "-o", path("events.csv")}).exit_code, 0);
  const json keytimes = json::parse(keys({"--json"}).out)["result"]["keytimes"];
  std::istringstream stream(get(path("events.csv")));
  std::string line;
  std::getline(stream, line);
  EXPECT_EQ(line, "file,event,time [s],frame");
  for (const std::string& name : {path("takes/a.bvh"), path("takes/b.bvh")}) {
    for (const json& key : keytimes) {
      ASSERT_TRUE(std::getline(stream, line));
      std::istringstream row(line);
      std::string file, event, time;
      std::getline(row, file, ',');
      std::getline(row, event, ',');
      std::getline(row, time, ',');
      EXPECT_EQ(file, name);
      EXPECT_EQ(event, key["name"].get<std::string>());
      EXPECT_NEAR(std::stod(time), key["time"].get<double>(), 1e-6);
    }
  }
  EXPECT_FALSE(std::getline(stream, line));
  EXPECT_EQ(keys({"-o", path("e.csv"), "--keytime", "left_off=1s"}).exit_code, 2);
}

TEST_F(KrokKeys, SetMovesMarksAndStays) {
  ASSERT_EQ(keys({"-o", file_}).exit_code, 0);
  const std::size_t count = written()["keytimes"].size();
  const double before = time_of(written(), "left_off");
  ASSERT_EQ(keys({"-o", file_, "--keytime",
                  "left_off=" + std::to_string(before + 0.05) + "s,clap=120f", "--new"})
                .exit_code,
            0);
  EXPECT_NEAR(time_of(written(), "left_off"), before + 0.05, 1e-6);
  EXPECT_EQ(time_of(written(), "clap"), 2.0);
  EXPECT_EQ(written()["keytimes"].size(), count + 1);
  // Neither a run like the first nor one that finds anew loses them.
  for (const char* find : {"auto", "steps"}) {
    const ToolRun again = keys({"-o", file_, "--find", find});
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_NEAR(time_of(written(), "left_off"), before + 0.05, 1e-6) << find;
    EXPECT_EQ(time_of(written(), "clap"), 2.0) << find;
    EXPECT_EQ(written()["keytimes"].size(), count + 1) << find;
  }
  ASSERT_EQ(keys({"-o", file_, "--discard-edits"}).exit_code, 0);
  EXPECT_EQ(time_of(written(), "left_off"), before);
  EXPECT_EQ(time_of(written(), "clap"), -1);
}

TEST_F(KrokKeys, AnEditInATextEditorIsKept) {
  ASSERT_EQ(keys({"-o", file_}).exit_code, 0);
  json file = written();
  // As the tool writes times: microseconds.
  const double moved = file["keytimes"][3]["time"].get<double>() + 0.02;
  file["keytimes"][3]["time"] = std::round(1e6 * moved) / 1e6;
  write(file);
  const ToolRun run = keys({"-o", file_});
  ASSERT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("edited by hand"));
  EXPECT_EQ(written()["keytimes"], file["keytimes"]);
  // It stays known as edited though the file is now the tool's own writing.
  ASSERT_EQ(keys({"-o", file_}).exit_code, 0);
  EXPECT_EQ(written()["keytimes"], file["keytimes"]);
  const std::string stood = get(file_);
  const ToolRun refused = keys({"-o", file_, "--find", "steps"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(has_code(refused.err, "keys-edited")) << refused.err;
  EXPECT_EQ(get(file_), stood);
}

TEST_F(KrokKeys, RemovedStaysRemoved) {
  ASSERT_EQ(keys({"-o", file_, "--remove", "right_off"}).exit_code, 0);
  EXPECT_EQ(time_of(written(), "right_off"), -1);
  ASSERT_EQ(keys({"-o", file_}).exit_code, 0);
  EXPECT_EQ(time_of(written(), "right_off"), -1);
  const ToolRun none = keys({"-o", file_, "--remove", "right_off@1s"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_TRUE(has_code(none.err, "keys-none"));
}

TEST_F(KrokKeys, ContactsCanBeAddedAndTakenOut) {
  ASSERT_EQ(keys({"-o", file_, "--add-contact", "LeftHand=1s..1.5s"}).exit_code, 0);
  json hand;
  const json file = written();
  for (const json& contact : file["contacts"]) {
    if (contact["joint"] == "LeftHand") hand = contact;
  }
  ASSERT_FALSE(hand.is_null());
  EXPECT_EQ(hand["by"], "hand");
  EXPECT_GT(hand["place"][1].get<double>(), 0.5);
  ASSERT_EQ(keys({"-o", file_, "--remove-contact", "LeftHand@1.2s"}).exit_code, 0);
  EXPECT_THAT(get(file_), Not(HasSubstr("LeftHand")));
  for (const char* wrong : {"LeftHand", "LeftHand=1s", "LeftHoof=1s..2s", "LeftHand=2s..1s",
                            "LeftHand=1s..99s", "=1s..2s", "LeftHand=x..y"}) {
    EXPECT_EQ(keys({"-o", file_, "--add-contact", wrong}).exit_code, 2) << wrong;
  }
}

TEST_F(KrokKeys, SaysWhatCannotBe) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--keytime", "left_off=1s"},  // no -o
                                             {"-o", file_, "--keytime", "left_off"},
                                             {"-o", file_, "--keytime", "=1s"},
                                             {"-o", file_, "--keytime", "left_off=99s"},
                                             {"-o", file_, "--keytime", "a=1s,b=1s"},
                                             {"-o", file_, "--find", "everything"},
                                             {"-o", file_, "--find", "none", "--discard-edits"},
                                             {"--contacts", path("none.json")}}) {
    const ToolRun run = keys(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments.back();
    EXPECT_THAT(run.err, HasSubstr("error: ")) << arguments.back();
  }
  EXPECT_THAT(listing(), ElementsAre("walk.bvh"));
}

TEST_F(KrokKeys, ABrokenFileIsNotReplacedUnasked) {
  put("walk.keys.json", "{\"schema\": \"krok.keys/1\", \"keytimes\": [");
  const ToolRun run = keys({"-o", file_});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("walk.keys.json:1:"));
  EXPECT_EQ(get(file_), "{\"schema\": \"krok.keys/1\", \"keytimes\": [");
  EXPECT_EQ(keys({"-o", file_, "--discard-edits"}).exit_code, 0);
  EXPECT_EQ(written()["keytimes"].size(), 17U);
}

TEST_F(KrokKeys, PlotsTheFeet) {
  ASSERT_EQ(keys({"--plot", path("walk.svg")}).exit_code, 0);
  const std::string svg = get(path("walk.svg"));
  EXPECT_THAT(svg, HasSubstr("<svg"));
  for (const char* part : {"left foot", "right foot", "speed", "height", "left_strike", "heel"}) {
    EXPECT_THAT(svg, HasSubstr(part));
  }
}

TEST_F(KrokKeys, AnswersNoWhereThereIsNoStep) {
  const std::string still = put("still.bvh", capture(40));
  const ToolRun run = run_tool("krok-keys", {still});
  EXPECT_EQ(run.exit_code, 2);  // a chain of three joints has no feet
  EXPECT_TRUE(has_code(run.err, "contacts-feet")) << run.err;
  // One frame of the walk holds no step.
  std::string text = get(kWalk);
  const auto frames = text.find("Frames:");
  std::size_t end = text.find('\n', text.find("Frame Time", frames));
  for (int i = 0; i < 5; ++i) end = text.find('\n', end + 1);
  text = text.substr(0, frames) + "Frames: 5" +
         text.substr(text.find('\n', frames), end + 1 - text.find('\n', frames));
  const std::string brief = put("brief.bvh", text);
  EXPECT_EQ(run_tool("krok-keys", {brief}).exit_code, 0);
  EXPECT_EQ(run_tool("krok-keys", {brief, "--find", "steps"}).exit_code, 1);
}

TEST_F(KrokKeys, ManyFilesEachBesideItsMotion) {
  std::filesystem::create_directory(path("in"));
  put("in/a.bvh", get(kWalk));
  put("in/b.bvh", get(kWalk));
  const auto batch = [&] {
    return run_tool("krok-keys", {path("in"), "--out-dir", path("in"), "-j", "2"});
  };
  ASSERT_EQ(batch().exit_code, 0);
  EXPECT_EQ(get(path("in/a.keys.json")), get(path("in/b.keys.json")));
  // Edited between two runs of the batch.
  json edited = json::parse(get(path("in/b.keys.json")));
  edited["keytimes"].push_back({{"name", "clap"}, {"time", 1.0}, {"by", "hand"}});
  put("in/b.keys.json", edited.dump());
  const ToolRun again = batch();
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(get(path("in/b.keys.json")), HasSubstr("clap"));
}

}  // namespace
}  // namespace krok::test
