// If these fail, krok-blend leaves its user with a motion that is not what was asked for, without
// keytimes, or without knowing why there is none. What a blend is, is tested in tests/unit/blend.

#include <gmock/gmock.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "cli/kept_files.h"

namespace krok::test {
namespace {

class KrokBlend : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    const ToolRun imported = run_tool("krok-import", {kWalk, "-o", path("walk.anim"), "-q"});
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    // The same walk, twice as fast.
    const ToolRun quick = run_tool(
        "krok-edit", {path("walk.anim"), "--playback-speed", "2", "-o", path("quick.anim"), "-q"});
    ASSERT_EQ(quick.exit_code, 0) << quick.err;
  }
  ToolRun blend(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"-o", path("out.anim")});
    return run_tool("krok-blend", arguments);
  }
  json result_of(const std::vector<std::string>& arguments) const {
    std::vector<std::string> all = arguments;
    all.emplace_back("--json");
    const ToolRun run = blend(all);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? json::parse(run.out)["result"] : json();
  }
  std::string walk(const std::string& weight) const { return path("walk.anim") + ":" + weight; }
  std::string quick(const std::string& weight) const { return path("quick.anim") + ":" + weight; }
};

TEST_F(KrokBlend, AMotionWithItselfIsItself) {
  const ToolRun run = blend({walk("0.4"), walk("0.6")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  const ToolRun diff =
      run_tool("krok-diff", {path("walk.anim"), path("out.anim"), "--tolerance", "0.01mm"});
  EXPECT_EQ(diff.exit_code, 0) << diff.out << diff.err;
  EXPECT_THAT(listing(),
              UnorderedElementsAre("walk.anim", "quick.anim", "out.anim", "out.keys.json"));
}

// Its files would have to be listed one by one.
TEST_F(KrokBlend, AFolderIsAllItsMotions) {
  std::filesystem::create_directory(path("walks"));
  for (const char* name : {"walk.anim", "quick.anim"}) {
    std::filesystem::copy(path(name), path("walks/" + std::string(name)));
  }
  ASSERT_EQ(run_here("krok-blend", {"walks", "-o", "mean.anim"}).exit_code, 0);
  ASSERT_EQ(
      run_here("krok-blend", {"walks/quick.anim", "walks/walk.anim", "-o", "two.anim"}).exit_code,
      0);
  const ToolRun diff = run_here("krok-diff", {"mean.anim", "two.anim", "--tolerance", "0.01mm"});
  EXPECT_EQ(diff.exit_code, 0) << diff.out << diff.err;
}

TEST_F(KrokBlend, KeytimesAreFoundAndWritten) {
  const json result = result_of({walk("0.5"), quick("0.5")});
  const auto& moments = result["moments"];
  ASSERT_GE(moments.size(), 6u);
  EXPECT_NE(std::find(moments.begin(), moments.end(), "left_strike"), moments.end());
  // Half the speed and double the speed of 1.5 times the quick one's time.
  const json& slow = result["motions"][0]["times"];
  const json& fast = result["motions"][1]["times"];
  const json written = json::parse(get(path("out.keys.json")));
  std::size_t k = moments[0] == "begin" ? 1 : 0;
  for (const json& key : result["keytimes"]) {
    EXPECT_EQ(key["name"], moments[k]);
    const double expected = 0.5 * (slow[k].get<double>() - slow[0].get<double>() +
                                   fast[k].get<double>() - fast[0].get<double>());
    EXPECT_NEAR(key["time"].get<double>(), expected, 0.02) << k;
    ++k;
  }
  EXPECT_EQ(written["keytimes"].size(), result["keytimes"].size());
}

// Would fail if a blend were shorter than a motion of weight 1 without a word.
TEST_F(KrokBlend, WhatHasNoCounterpartIsNamed) {
  const ToolRun cut =
      run_tool("krok-edit", {path("quick.anim"), "--from", "1s", "-o", path("late.anim"), "-q"});
  ASSERT_EQ(cut.exit_code, 0) << cut.err;
  const ToolRun run = blend({walk("1"), path("late.anim") + ":0"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("walk.anim: "));
  EXPECT_THAT(run.err, HasSubstr("are used, what has a counterpart in the others"));
  EXPECT_THAT(blend({walk("1"), walk("0")}).err, Not(HasSubstr("are used")));
}

TEST_F(KrokBlend, WeightsFromATable) {
  put("in.csv", "generic,weight\n0,0\n1,1\n");
  put("out.csv", "generic,weight\n0,1\n1,0\n");
  const json result = result_of({walk("@" + path("out.csv")), quick("@" + path("in.csv")),
                                 "--contacts", "none", "--save-warp", path("warp.csv")});
  EXPECT_EQ(result["moments"], json({"begin", "end"}));
  const std::string warp = get(path("warp.csv"));
  EXPECT_THAT(warp, HasSubstr("time [s],generic,walk.anim [s],quick.anim [s]\n0.000000,0.000000,"));
  EXPECT_EQ(static_cast<int>(std::count(warp.begin(), warp.end(), '\n')),
            result["frames"].get<int>() + 1);

  put("back.csv", "generic,weight\n1,0\n0,1\n");
  const ToolRun back = blend({walk("@" + path("back.csv")), quick("0.5")});
  EXPECT_EQ(back.exit_code, 2);
  EXPECT_TRUE(has_code(back.err, "weight-curve")) << back.err;
  put("words.csv", "generic,weight\n0,much\n");
  const ToolRun words = blend({walk("@" + path("words.csv")), quick("0.5")});
  EXPECT_EQ(words.exit_code, 2);
  EXPECT_THAT(words.err, HasSubstr("words.csv:2:3: error:"));
  const ToolRun none = blend({walk("@" + path("none.csv")), quick("0.5")});
  EXPECT_EQ(none.exit_code, 2);
}

TEST_F(KrokBlend, DtwMatchesWithoutKeytimes) {
  const json result = result_of({walk("0.5"), quick("0.5"), "--warp", "dtw"});
  ASSERT_GE(result["moments"].size(), 8u);
  const json& slow = result["motions"][0]["times"];
  const json& fast = result["motions"][1]["times"];
  for (std::size_t k = 0; k < slow.size(); ++k) {
    EXPECT_NEAR(2 * fast[k].get<double>(), slow[k].get<double>(), 0.1) << k;
  }
}

TEST_F(KrokBlend, SumsOtherThanOneAreRefusedWithAHint) {
  const ToolRun run = blend({walk("0.5"), quick("0.6")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "blend-sum")) << run.err;
  EXPECT_THAT(run.err, HasSubstr("sum to 1.1"));
  EXPECT_THAT(run.err, HasSubstr("--modifier"));
  EXPECT_EQ(blend({walk("1"), quick("0.1"), "--modifier"}).exit_code, 0);
}

TEST_F(KrokBlend, WordsWithoutAWeightAreToldBeforeAnythingIsRead) {
  for (const std::string& word :
       {path("gone.anim:x"), path("gone.anim:"), path("gone.anim:0x1"), std::string(":1")}) {
    const ToolRun run = blend({word});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_TRUE(has_code(run.err, "usage")) << word << run.err;
  }
}

TEST_F(KrokBlend, MotionsWithoutWeightsHaveEqualShares) {
  const std::string given = path("given.anim"), equal = path("equal.anim");
  ASSERT_EQ(run_tool("krok-blend", {walk("0.5"), quick("0.5"), "-o", given}).exit_code, 0);
  const auto bare = [](std::string word) { return word.substr(0, word.rfind(':')); };
  ASSERT_EQ(run_tool("krok-blend", {bare(walk("0.5")), bare(quick("0.5")), "-o", equal}).exit_code,
            0);
  EXPECT_EQ(run_tool("krok-diff", {given, equal}).exit_code, 0);
  const ToolRun mixed = blend({bare(walk("0.5")), quick("0.5")});
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_THAT(mixed.err, HasSubstr("some motions have a weight"));
}

TEST_F(KrokBlend, OtherSkeletonsAreRefused) {
  put("chain.bvh", capture(60));
  const ToolRun run = blend({walk("0.5"), path("chain.bvh") + ":0.5", "--contacts", "none"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "blend-skeleton")) << run.err;
  EXPECT_THAT(run.err, HasSubstr("krok-retarget"));
  EXPECT_THAT(listing(), UnorderedElementsAre("walk.anim", "quick.anim", "chain.bvh"));
}

TEST_F(KrokBlend, MotionsWithoutStepsAreMatchedFromEndToEnd) {
  put("chain.bvh", capture(60));
  const std::string chain = path("chain.bvh") + ":0.5";
  const ToolRun run = blend({chain, chain});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("from beginning to end"));
  const ToolRun beside = blend({chain, chain, "--contacts", "sidecar"});
  EXPECT_EQ(beside.exit_code, 2);
  EXPECT_TRUE(has_code(beside.err, "keys-missing")) << beside.err;
}

TEST_F(KrokBlend, WithoutContactsNothingCanBeKeptInPlaceAndThatIsSaid) {
  const ToolRun run =
      blend({walk("0.5"), quick("0.5"), "--contacts", "none", "--match-root", "stance"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has_code(run.err, "blend-stance")) << run.err;
  const ToolRun known = blend({walk("0.5"), quick("0.5"), "--match-root", "stance"});
  EXPECT_FALSE(has_code(known.err, "blend-stance")) << known.err;
}

// Feet of a blend drift by millimetres, which is seen; the figures are those of what is written.
TEST_F(KrokBlend, FeetArePlantedWhereThatIsAskedFor) {
  const auto drift_of = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {walk("0.5"), quick("0.5"), "--json"});
    const ToolRun run = blend(more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out)["result"];
  };
  EXPECT_FALSE(drift_of({}).contains("planted"));
  const json planted = drift_of({"--plant"})["planted"];
  EXPECT_LE(planted["drift"].get<double>(), 1e-3);
  EXPECT_LE(planted["drift"], planted["drift_before"]);
  // Nothing is left to do.
  const ToolRun again =
      run_tool("krok-edit", {path("out.anim"), "--plant", "-o", path("again.anim"), "--json"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const ToolRun diff =
      run_tool("krok-diff", {path("out.anim"), path("again.anim"), "--tolerance", "1mm"});
  EXPECT_EQ(diff.exit_code, 0) << diff.out << diff.err;
}

// Planted feet are locked unless told otherwise; without contacts that goes without a warning.
TEST_F(KrokBlend, FeetAreLockedUnlessToldOtherwise) {
  const auto bytes_with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {walk("0.5"), quick("0.5")});
    const ToolRun run = blend(more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_FALSE(has_code(run.err, "blend-stance")) << run.err;
    const ToolRun bvh = run_tool("krok-export", {path("out.anim"), "-o", path("out.bvh"), "-q"});
    EXPECT_EQ(bvh.exit_code, 0) << bvh.err;
    return get(path("out.bvh"));
  };
  const std::string usual = bytes_with({});
  EXPECT_TRUE(usual == bytes_with({"--match-root", "stance"}));
  EXPECT_FALSE(usual == bytes_with({"--match-root", "root"}));
  EXPECT_TRUE(bytes_with({"--contacts", "none"}) ==
              bytes_with({"--contacts", "none", "--match-root", "root"}));
}

TEST_F(KrokBlend, KeytimesThatAPersonWroteStay) {
  put("out.keys.json", "{\"schema\": \"something else\"}\n");
  const ToolRun run = blend({walk("0.5"), quick("0.5")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "keys-edited")) << run.err;
  EXPECT_EQ(get(path("out.keys.json")), "{\"schema\": \"something else\"}\n");
}

}  // namespace
}  // namespace krok::test
