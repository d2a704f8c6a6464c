// If these fail, krok-edit --plant leaves feet sliding, takes no notice of a sidecar, or fails
// without a word that helps.

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/motion_fixture.h"
#include "support/planted_measures.h"

namespace krok::test {
namespace {

using testing::HasSubstr;

class KrokEditPlant : public test::MotionTest {
 protected:
  KrokEditPlant() {
    samples::WalkOptions options;
    options.steps = 6;
    walk_ = samples::make_walk(options).value();
    write("walk.anim", test::with_skate(walk_, {.body_jitter = 0.001}));
  }

  samples::Walk walk_;
};

TEST_F(KrokEditPlant, FeetStandAndTheReportSaysWhere) {
  const auto done = run_here("krok-edit", {"walk.anim", "--plant", "-o", "planted.anim", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto step = nlohmann::json::parse(done.out)["result"]["steps"][0];
  EXPECT_EQ(step["step"], "plant");
  EXPECT_EQ(step["contacts"], "found");
  EXPECT_GT(step["drift_before"], 0.02);
  EXPECT_LT(step["drift"], 0.0005);
  const Clip planted = read("planted.anim");
  int stays = 0;
  for (const auto& stay : step["stays"]) {
    if (stay["part"] != "ball") continue;
    ++stays;
    const int joint = planted.skeleton.find(stay["joint"].get<std::string>());
    ASSERT_GE(joint, 0);
    for (int f = stay["first_frame"]; f <= stay["last_frame"]; ++f) {
      const Vec3 place = test::joint_of(planted, f, joint).position;
      const Vec3 wanted(stay["place"][0], stay["place"][1], stay["place"][2]);
      EXPECT_LT((place - wanted).norm(), 0.0005);
    }
  }
  EXPECT_GE(stays, 6);
}

// Would fail if the keytimes of another motion were used without a word: feet were held a third of
// a metre beside the steps.
TEST_F(KrokEditPlant, KeysOfAnotherMotionAreToldOrLeftOut) {
  ASSERT_EQ(run_here("krok-keys", {"walk.anim", "-o", "walk.keys.json"}).exit_code, 0);
  const auto own = run_here("krok-edit", {"walk.anim", "--plant", "-o", "planted.anim"});
  EXPECT_EQ(own.err.find("keys-stale"), std::string::npos) << own.err;
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--mirror", "-o", "mirrored.anim"}).exit_code, 0);
  std::filesystem::copy_file(path("walk.keys.json"), path("mirrored.keys.json"));
  const auto mirrored =
      run_here("krok-edit", {"mirrored.anim", "--plant", "-o", "planted.anim", "--json"});
  EXPECT_THAT(mirrored.err, HasSubstr("keys-stale"));
  EXPECT_EQ(nlohmann::json::parse(mirrored.out)["result"]["steps"][0]["contacts"], "found");

  // Other joints: not used, unless somebody edited it.
  Clip renamed = walk_.clip;
  for (std::string& name : renamed.skeleton.names) name = "hero:" + name;
  write("renamed.anim", renamed);
  std::filesystem::copy_file(path("walk.keys.json"), path("renamed.keys.json"));
  const auto left_out =
      run_here("krok-edit", {"renamed.anim", "--plant", "-o", "planted.anim", "--json"});
  ASSERT_EQ(left_out.exit_code, 0) << left_out.err;
  EXPECT_THAT(left_out.err, HasSubstr("keys-stale"));
  EXPECT_EQ(nlohmann::json::parse(left_out.out)["result"]["steps"][0]["contacts"], "found");
  put("renamed.keys.json", R"({"schema": "krok.keys/1", "contacts": [
    {"joint": "LeftToeBase", "start": 1.0, "end": 1.2, "place": [0, 0, 0], "by": "hand"}]})");
  const auto refused = run_here("krok-edit", {"renamed.anim", "--plant", "-o", "planted.anim"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--discard-edits"));
}

TEST_F(KrokEditPlant, ContactsOfTheSidecarAreTaken) {
  put("walk.keys.json", R"({"schema": "krok.keys/1", "contacts": [
    {"joint": "LeftToeBase", "start": 1.0, "end": 1.2, "place": [0, 0, 0]}]})");
  const auto with = run_here("krok-edit", {"walk.anim", "--plant", "-o", "a.anim", "--json"});
  ASSERT_EQ(with.exit_code, 0) << with.err;
  auto step = nlohmann::json::parse(with.out)["result"]["steps"][0];
  EXPECT_EQ(step["contacts"], "file");
  int balls = 0;
  for (const auto& stay : step["stays"]) {
    if (stay["part"] != "ball") continue;
    ++balls;
    EXPECT_EQ(stay["first_frame"], 60);
    EXPECT_EQ(stay["last_frame"], 72);
  }
  EXPECT_EQ(balls, 1);
  const auto found = run_here(
      "krok-edit", {"walk.anim", "--plant", "--contacts", "find", "-o", "b.anim", "--json"});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  EXPECT_EQ(nlohmann::json::parse(found.out)["result"]["steps"][0]["contacts"], "found");
  put("mine.json", get(path("walk.keys.json")));
  const auto mine =
      run_here("krok-edit", {"walk.anim", "--plant", "--contacts", "mine.json", "-o", "c.anim"});
  ASSERT_EQ(mine.exit_code, 0) << mine.err;
  EXPECT_EQ(read("c.anim").positions, read("a.anim").positions);
}

// A later cut must not move contacts, which are at times of the input.
TEST_F(KrokEditPlant, IsDoneBeforeTheCut) {
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--plant", "-o", "whole.anim"}).exit_code, 0);
  ASSERT_EQ(
      run_here("krok-edit", {"walk.anim", "--from", "60f", "--plant", "-o", "part.anim"}).exit_code,
      0);
  const Clip whole = read("whole.anim"), part = read("part.anim");
  ASSERT_EQ(part.frame_count(), whole.frame_count() - 60);
  for (std::size_t j = 0; j < whole.skeleton.names.size(); ++j) {
    EXPECT_EQ(part.frame_positions(0)[j], whole.frame_positions(60)[j]);
  }
}

TEST_F(KrokEditPlant, TheSameBytesForAnyNumberOfThreads) {
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--plant", "-j1", "-o", "a.anim"}).exit_code, 0);
  const std::string one = get(path("a.anim"));
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--plant", "-j4", "-o", "a.anim"}).exit_code, 0);
  EXPECT_EQ(get(path("a.anim")), one);
}

TEST_F(KrokEditPlant, WhatCannotBePlantedIsAnError) {
  const auto refused = [&](std::vector<std::string> arguments, const char* code) {
    const auto done = run_here("krok-edit", std::move(arguments));
    EXPECT_EQ(done.exit_code, 2) << done.err;
    EXPECT_TRUE(test::has_code(done.err, code)) << done.err;
    EXPECT_FALSE(std::filesystem::exists(path("out.anim")));
    return done.err;
  };
  put("chain.bvh", capture(60));
  EXPECT_THAT(refused({"chain.bvh", "--plant", "-o", "out.anim"}, "contacts-feet"),
              HasSubstr("chain.bvh"));
  put("none.json", R"({"schema": "krok.keys/1", "contacts": []})");
  EXPECT_THAT(refused({"walk.anim", "--plant", "--contacts", "none.json", "-o", "out.anim"},
                      "plant-contacts"),
              HasSubstr("nothing can be planted"));
  refused({"walk.anim", "--contacts", "find", "-o", "out.anim"}, "usage");
  refused({"walk.anim", "--plant", "--contacts", "missing.json", "-o", "out.anim"}, "file-missing");
}

}  // namespace
}  // namespace krok::test
