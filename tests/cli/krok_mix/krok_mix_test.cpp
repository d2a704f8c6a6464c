// If these fail, krok-mix leaves its user with a motion that is not what the timeline says, or with
// half of one, or without knowing where the mistake in it is. What a mix is, is tested in
// tests/unit/timeline.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "cli/kept_files.h"

namespace krok::test {
namespace {

class KrokMix : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    std::filesystem::create_directory(path("in"));
    const ToolRun imported = run_tool("krok-import", {kWalk, "-o", path("in/walk.anim"), "-q"});
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    const ToolRun quick = run_tool("krok-edit", {path("in/walk.anim"), "--playback-speed", "1.5",
                                                 "-o", path("in/quick.anim"), "-q"});
    ASSERT_EQ(quick.exit_code, 0) << quick.err;
  }

  // A timeline in a folder beside the motions, which its paths begin at.
  std::string timeline(const std::string& base, const std::string& rest = "",
                       const std::string& name = "in/t.json") const {
    return put(name,
               "{\"schema\": \"krok.timeline/1\",\n \"sources\": {\"walk\": \"walk.anim\", "
               "\"quick\": \"quick.anim\"},\n \"base\": [\n" +
                   base + "]" + rest + "}\n");
  }
  ToolRun mix(const std::string& file, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {file, "-o", path("out.anim")});
    return run_tool("krok-mix", more);
  }
  json result_of(const std::string& file, std::vector<std::string> more = {}) const {
    more.emplace_back("--json");
    const ToolRun run = mix(file, more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? json::parse(run.out)["result"] : json();
  }
};

const std::string kFade =
    "{\"source\": \"walk\", \"to\": \"2.5s\", \"marks\": [{\"name\": \"look\", \"at\": \"1s\"}]},\n"
    "{\"source\": \"quick\", \"change\": {\"kind\": \"crossfade\", \"duration\": \"0.5s\"}}";

TEST_F(KrokMix, AMotionAloneIsItself) {
  const ToolRun run = mix(timeline("{\"source\": \"walk\"}"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  const ToolRun diff =
      run_tool("krok-diff", {path("in/walk.anim"), path("out.anim"), "--tolerance", "0"});
  EXPECT_EQ(diff.exit_code, 0) << diff.out << diff.err;
  EXPECT_THAT(listing(), UnorderedElementsAre("in", "out.anim", "out.keys.json"));
}

TEST_F(KrokMix, TellsItemsChangesAndEvents) {
  const json result = result_of(timeline(kFade));
  EXPECT_EQ(result["items"].size(), 2u);
  EXPECT_NEAR(result["items"][1]["start"].get<double>(), 2.0, 1e-9);
  ASSERT_EQ(result["changes"].size(), 1u);
  const json& change = result["changes"][0];
  EXPECT_EQ(change["kind"], "crossfade");
  EXPECT_EQ(change["into"], "quick");
  EXPECT_EQ(change["in_step"], true);
  EXPECT_EQ(change["pops"], false);
  EXPECT_LT(change["angular_velocity"], change["usual_angular_velocity"]);
  std::vector<std::string> events;
  for (const json& event : result["events"]) {
    events.push_back(event["event"].get<std::string>() + " " + event["item"].get<std::string>());
  }
  EXPECT_THAT(events, testing::ElementsAre("begin walk", "mark walk", "begin quick", "end walk",
                                           "end quick"));
  EXPECT_EQ(result["events"][1]["name"], "look");
  EXPECT_NEAR(result["events"][1]["time"].get<double>(), 1, 1e-9);
  // The keytimes are those of the file beside the result.
  const json keys = json::parse(get(path("out.keys.json")));
  EXPECT_EQ(keys["keytimes"].size(), result["keytimes"].size());
  EXPECT_GT(result["keytimes"].size(), 8u);
}

TEST_F(KrokMix, TheSameBytesOnAnyNumberOfThreads) {
  const std::string file = timeline(
      kFade +
          ", {\"source\": \"walk\", \"loop\": 2, \"change\": {\"kind\": \"inertial\", "
          "\"duration\": 0.3}}",
      ", \"layers\": [{\"mode\": \"additive\", \"mask\": [{\"below\": \"Spine\"}], \"items\": "
      "[{\"source\": \"quick\", \"loop\": true}]}]");
  ASSERT_EQ(mix(file, {"-j", "1"}).exit_code, 0);
  const std::string one = get(path("out.anim")), keys = get(path("out.keys.json"));
  ASSERT_EQ(mix(file, {"-j", "2"}).exit_code, 0);
  EXPECT_EQ(get(path("out.anim")), one);
  EXPECT_EQ(get(path("out.keys.json")), keys);
}

TEST_F(KrokMix, MistakesAreToldByLineAndColumnAndLeaveNothing) {
  struct Mistake {
    std::string base, place, code;
  };
  const Mistake mistakes[] = {
      {"{\"source\": \"walk\", \"lop\": 2}", "t.json:4:20: error:", "timeline-structure"},
      {"{\"source\": \"wakl\"}", "t.json:4:12: error:", "timeline-value"},
      {"{\"source\": \"walk\", \"from\": \"90s\"}", "t.json:4:1: error:", "timeline-time"},
      {"{\"source\": \"walk\"},\n  {\"source\": \"walk\", \"sequence\": \"x\"}",
       "t.json:5:3: error:", "timeline-source"},
      {"{\"source\": \"walk\", \"loop\": true}", "t.json:4:1: error:", "timeline-endless"},
      {"{\"source\": \"walk\"},\n{\"source\": \"quick\", \"at\": 99}",
       "t.json:5:1: error:", "timeline-time"},
      {"{\"source\": \"walk\"", "t.json:4:18: error:", "json-syntax"}};
  for (const Mistake& mistake : mistakes) {
    const ToolRun run = mix(timeline(mistake.base));
    EXPECT_EQ(run.exit_code, 2) << mistake.base;
    EXPECT_THAT(run.err, HasSubstr(mistake.place)) << mistake.base;
    EXPECT_TRUE(has_code(run.err, mistake.code)) << run.err;
    EXPECT_THAT(listing(), UnorderedElementsAre("in")) << mistake.base;
  }
  const ToolRun longer =
      mix(timeline("{\"source\": \"walk\"},\n{\"source\": \"quick\", \"change\": {\"kind\": "
                   "\"crossfade\", \"duration\": \"40s\"}}"));
  EXPECT_THAT(longer.err, AllOf(HasSubstr("t.json:5:1: error: quick: the crossfade takes 40 s, but "
                                          "walk plays for"),
                                HasSubstr("loop the item before it")));
  const ToolRun mask = mix(timeline("{\"source\": \"walk\"}",
                                    ",\n\"layers\": [{\"mask\": [{\"below\": \"Tail\"}], "
                                    "\"items\": []}]"));
  EXPECT_THAT(mask.err, HasSubstr("t.json:5:22: error: no joint is called 'Tail'"));
  EXPECT_EQ(mask.exit_code, 2);
}

// Would fail if a motion of which hardly anything is played passed for one that is played.
TEST_F(KrokMix, AnItemThatIsHardlyPlayedIsWarnedOf) {
  const std::string twice = timeline(
      "{\"source\": \"walk\"}, {\"source\": \"walk\", \"to\": \"1.4s\", \"change\": {\"kind\": "
      "\"crossfade\", "
      "\"duration\": \"0.2s\"}}");
  const json item = result_of(twice)["items"][1];
  const double played = item["end"].get<double>() - item["start"].get<double>();
  ASSERT_GT(item["skipped"].get<double>(), played);
  EXPECT_TRUE(has_code(mix(twice).err, "timeline-skipped"));
}

// Would fail if the beginning of a motion were left out without a word.
TEST_F(KrokMix, WhatTimeAlignmentLeavesOutIsPrinted) {
  const ToolRun run = mix(timeline(kFade));
  const double skipped = result_of(timeline(kFade))["items"][1]["skipped"].get<double>();
  ASSERT_GT(skipped, 0.01);
  EXPECT_THAT(run.err, AllOf(HasSubstr("quick: its first "), HasSubstr(" s are left out")));
}

// Would fail if a file of another kind were answered with the first of its keys.
TEST_F(KrokMix, FilesOfOtherKindsLeadOn) {
  put("w.json", R"({"schema": "krok.weights/1", "curves": []})");
  EXPECT_THAT(run_here("krok-mix", {"w.json", "-o", "o.anim"}).err,
              AllOf(HasSubstr("w.json:1:12: error: the schema is 'krok.weights/1'"),
                    HasSubstr("krok-skin --weights")));
  put("a.bvh", capture(5));
  EXPECT_THAT(run_here("krok-mix", {"a.bvh", "-o", "o.anim"}).err,
              AllOf(HasSubstr("is a BVH text file, not a timeline"), HasSubstr("krok-blend")));
  EXPECT_THAT(run_here("krok-mix", {"a.bvh", "b.bvh", "-o", "o.anim"}).err,
              HasSubstr("krok-edit A --append B"));
}

TEST_F(KrokMix, MotionsThatAreGoneOrOfAnotherSkeletonAreTold) {
  const std::string gone = put("in/gone.json",
                               "{\"schema\": \"krok.timeline/1\", \"sources\": {\"a\": "
                               "\"gone.anim\"}, \"base\": [{\"source\": \"a\"}]}");
  const ToolRun missing = mix(gone);
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("in/gone.anim"));
  put("in/chain.bvh", capture(60));
  const std::string other = put("in/other.json",
                                "{\"schema\": \"krok.timeline/1\", \"sources\": {\"a\": "
                                "\"walk.anim\", \"b\": \"chain.bvh\"}, \"base\": [{\"source\": "
                                "\"a\"}]}");
  const ToolRun differs = mix(other);
  EXPECT_EQ(differs.exit_code, 2);
  EXPECT_TRUE(has_code(differs.err, "timeline-skeleton")) << differs.err;
  EXPECT_THAT(differs.err, HasSubstr("krok-retarget"));
  EXPECT_THAT(listing(), UnorderedElementsAre("in"));
}

TEST_F(KrokMix, CapturesAndSequencesByName) {
  put("in/chain.bvh", capture(60));
  put("in/parts.json",
      "{\"schema\": \"krok.sequences/1\", \"sequences\": [{\"name\": \"a\", \"first\": 10, "
      "\"last\": 30, \"loop\": true}]}");
  const std::string file =
      put("in/t.json",
          "{\"schema\": \"krok.timeline/1\", \"sources\": {\"c\": {\"file\": \"chain.bvh\", "
          "\"sequences\": \"parts.json\"}}, \"base\": [{\"source\": \"c\", \"sequence\": \"a\"}, "
          "{\"source\": \"c\", \"sequence\": \"a\", \"loop\": 3}]}");
  EXPECT_EQ(result_of(file, {"--contacts", "none"})["frames"], 81);
  // A wrong one names its own file.
  put("in/parts.json", "{\"schema\": \"krok.sequences/1\", \"sequences\": [{}]}");
  const ToolRun wrong = mix(file, {"--contacts", "none"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("parts.json:1:"));
}

TEST_F(KrokMix, ACutThatPopsIsWarnedOf) {
  const ToolRun run =
      mix(timeline("{\"source\": \"walk\", \"to\": 1},\n{\"source\": \"walk\", "
                   "\"from\": 2.6}"));
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(has_code(run.err, "mix-pop")) << run.err;
  EXPECT_THAT(run.err, HasSubstr("t.json:5:1: warning: the change (cut) into walk"));
  EXPECT_THAT(run.err, HasSubstr("inertial"));
}

// Would fail if a layer without a fade popped in silence, or one with fades were warned of.
TEST_F(KrokMix, ALayerThatPopsIsWarnedOf) {
  const auto layered = [&](const std::string& fades) {
    return mix(timeline("{\"source\": \"walk\"}",
                        ",\"layers\": [{\"mode\": \"override\", \"items\": [{\"source\": "
                        "\"quick\", \"from\": 1, \"to\": 2, \"at\": 0.9" +
                            fades + "}]}]"));
  };
  const ToolRun hard = layered("");
  EXPECT_EQ(hard.exit_code, 0) << hard.err;
  EXPECT_TRUE(has_code(hard.err, "mix-pop")) << hard.err;
  EXPECT_THAT(hard.err, HasSubstr("where it begins"));
  EXPECT_THAT(hard.err, HasSubstr("\"fade_in\" makes it smooth"));
  const ToolRun soft = layered(",\"fade_in\": 0.4, \"fade_out\": 0.4");
  EXPECT_EQ(soft.exit_code, 0) << soft.err;
  EXPECT_FALSE(has_code(soft.err, "mix-pop")) << soft.err;
}

TEST_F(KrokMix, KeysAreTakenFromBesideAMotion) {
  // A keytime that nobody would find.
  put("in/walk.keys.json",
      "{\"schema\": \"krok.keys/1\", \"keytimes\": [{\"name\": \"sneeze\", \"time\": 0.5}]}");
  const json result = result_of(timeline("{\"source\": \"walk\", \"speed\": 0.5}"));
  ASSERT_EQ(result["keytimes"].size(), 1u);
  EXPECT_EQ(result["keytimes"][0]["name"], "sneeze");
  EXPECT_NEAR(result["keytimes"][0]["time"].get<double>(), 1.0, 1e-6);
  const ToolRun sidecar = mix(timeline(kFade), {"--contacts", "sidecar"});
  EXPECT_EQ(sidecar.exit_code, 2);
  EXPECT_TRUE(has_code(sidecar.err, "keys-missing")) << sidecar.err;
}

TEST_F(KrokMix, KeytimesThatAPersonWroteStay) {
  put("out.keys.json", "{\"schema\": \"something else\"}\n");
  const ToolRun run = mix(timeline(kFade));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "keys-edited")) << run.err;
  EXPECT_EQ(get(path("out.keys.json")), "{\"schema\": \"something else\"}\n");
  EXPECT_THAT(listing(), UnorderedElementsAre("in", "out.keys.json"));
}

TEST_F(KrokMix, ManyTimelines) {
  timeline("{\"source\": \"walk\"}", "", "in/a.json");
  timeline(kFade, "", "in/b.json");
  const ToolRun run =
      run_tool("krok-mix", {path("in/a.json"), path("in/b.json"), "--out-dir", path("many")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(path("many/a.anim")));
  EXPECT_TRUE(std::filesystem::exists(path("many/b.anim")));
  EXPECT_TRUE(std::filesystem::exists(path("many/b.keys.json")));
}

}  // namespace
}  // namespace krok::test
