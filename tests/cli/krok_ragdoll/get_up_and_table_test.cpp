// If these fail, krok-ragdoll leaves what fell on the ground, makes other falls than a table asks
// for or in another order, gives another fall for saved bodies, or passes over mistakes in files.

#include <gmock/gmock.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "core/file.h"
#include "core/index.h"
#include "formats/anim/anim.h"
#include "formats/model/model_format.h"
#include "samples/generator/rise.h"
#include "samples/generator/walk.h"
#include "skin/bind.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kTable =
    "name,at [s],joint,x [Ns],y [Ns],z [Ns],time [ms]\n"
    "left,1,Spine2,90,0,20,\n"
    "back,0.5,Head,0,0,-60,700\n";

class RagdollFiles : public test::CliTest {
 protected:
  void SetUp() override {
    samples::WalkOptions options;
    options.steps = 4;
    options.rate = 60;
    save(samples::make_walk(options)->clip, "walk.anim");
    samples::RiseOptions rise;
    save(*samples::make_rise(rise), "front.anim");
    rise.from = samples::Lying::back;
    save(*samples::make_rise(rise), "back.anim");
  }
  void save(const Clip& clip, const std::string& name) const {
    auto file = OutputFile::create(path(name));
    ASSERT_TRUE(file.ok() && anim::write(clip, {}, *file).ok() && file->commit().ok());
  }
  test::ToolRun fall(std::vector<std::string> arguments) const {
    test::ToolOptions options;
    options.folder = folder_.string();
    return test::run_tool("krok-ragdoll", std::move(arguments), options);
  }
  json result(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const auto run = fall(std::move(arguments));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out)["result"];
  }
  void refused(std::vector<std::string> arguments, const std::string& place,
               const std::string& code, const std::string& text) const {
    const auto run = fall(std::move(arguments));
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr(place));
    EXPECT_THAT(run.err, HasSubstr("[" + code + "]"));
    EXPECT_THAT(run.err, HasSubstr(text));
  }
};

TEST_F(RagdollFiles, WhatFallsGetsUp) {
  const json up =
      result({"walk.anim", "--at", "1s", "--push", "Spine2=90Ns,0,20Ns", "--duration", "6s",
              "--get-up", "front.anim", "--get-up", "back.anim", "-o", "up.anim"});
  const json& rises = up["get_up"];
  EXPECT_EQ(rises["tried"].size(), 2u);
  EXPECT_LT(rises["acceleration"].get<double>(), 1.5 * rises["motion_acceleration"].get<double>());
  EXPECT_LT(rises["penetration"].get<double>(), 0.01);
  const auto file = InputFile::open(path("up.anim"));
  const auto clip = anim::read(file->bytes());
  const int last = clip->frame_count() - 1;
  EXPECT_GT(clip->frame_positions(last)[at(clip->skeleton.find("Head"))].y(), 1.4f);
  EXPECT_LT(clip->frame_positions(rises["first_frame"].get<int>())[0].y(), 0.4f);
  refused(
      {"walk.anim", "--at", "1s", "--duration", "200ms", "--get-up", "front.anim", "-o", "no.anim"},
      "walk.anim", "ragdoll-moving", "--duration");
}

// Would fail if a motion that begins standing were taken for one that gets up, without a word.
TEST_F(RagdollFiles, AMotionThatBeginsStandingIsWarnedOf) {
  const std::vector<std::string> arguments = {
      "walk.anim",          "--at",       "1s",      "--push",
      "Spine2=90Ns,0,20Ns", "--duration", "6s",      "--get-up",
      "walk.anim",          "-o",         "up.anim", "--json"};
  const auto run = fall(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json report = json::parse(run.out);
  EXPECT_EQ(report["result"]["get_up"]["crouches"], true);
  ASSERT_EQ(report["issues"].size(), 1u) << run.err;
  EXPECT_EQ(report["issues"][0]["code"], "ragdoll-rise-standing");
}

TEST_F(RagdollFiles, ATableGivesTheFallsOfItsRows) {
  put("pushes.csv", kTable);
  const json falls = result({"walk.anim", "--pushes", "pushes.csv", "--duration", "1s", "-j", "1",
                             "-o", "one_{name}.anim"})["falls"];
  ASSERT_EQ(falls.size(), 2u);
  EXPECT_EQ(falls[0]["name"], "left");
  EXPECT_EQ(falls[1]["output"], "one_back.anim");
  const json again = result({"walk.anim", "--pushes", "pushes.csv", "--duration", "1s", "-j", "2",
                             "-o", "two_{name}.anim"})["falls"];
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(again[i]["hash"], falls[i]["hash"]);
  const json alone = result({"walk.anim", "--at", "0.5s", "--push", "Head=0,0,-60@0.7s",
                             "--duration", "1s", "-o", "alone.anim"});
  EXPECT_EQ(alone["hash"], falls[1]["hash"]);
}

// One body that is shot upwards, and so cannot get up, would take the falls of all other rows
// along, or be passed over.
TEST_F(RagdollFiles, ARowThatFailsLeavesTheOthers) {
  put("pushes.csv",
      "name,at,joint,x,y,z\n"
      "up,1,Spine2,0,2500,0\n"
      "side,1,Spine2,90,0,20\n");
  const auto run = fall({"walk.anim", "--pushes", "pushes.csv", "--duration", "6s", "--get-up",
                         "front.anim", "--get-up", "back.anim", "-o", "{name}.anim", "--json"});
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.err, HasSubstr("pushes.csv:2:4: error: the fall 'up'"));
  EXPECT_THAT(run.err, HasSubstr("[ragdoll-moving]"));
  EXPECT_FALSE(std::filesystem::exists(path("up.anim")));
  EXPECT_TRUE(InputFile::open(path("side.anim")).ok());
  const json falls = json::parse(run.out)["result"]["falls"];
  ASSERT_EQ(falls.size(), 2u);
  EXPECT_EQ(falls[0]["status"], "failed");
  EXPECT_EQ(falls[0]["code"], "ragdoll-moving");
  EXPECT_TRUE(falls[0]["output"].is_null());
  EXPECT_EQ(falls[1]["status"], "done");
  EXPECT_GE(falls[1]["rest_time"].get<double>(), 0);
}

TEST_F(RagdollFiles, MistakesInATableAreToldWithTheirPlace) {
  const auto wrong = [&](const std::string& text, const std::string& place, const std::string& code,
                         const std::string& says) {
    put("bad.csv", text);
    refused({"walk.anim", "--pushes", "bad.csv", "-o", "{name}.anim"}, "bad.csv:" + place, code,
            says);
  };
  const std::string head = "name,at,joint,x,y,z\n";
  wrong("", "", "csv-empty", "");
  wrong("name,at,joint,x,y\na,1,Hips,1,2\n", "1:1", "pushes-column", "'z'");
  wrong("name,at,joint,x,y,z,w\na,1,Hips,1,2,3,4\n", "1:21", "pushes-column", "'w'");
  wrong("name,at [kg],joint,x,y,z\na,1,Hips,1,2,3\n", "1:6", "pushes-column", "kg");
  wrong(head + "a,1,Hips,1,nan,3\n", "2:12", "pushes-value", "nan");
  wrong(head + "a,1,Hips,1,2,1e99\n", "2:14", "pushes-value", "10000");
  wrong(head + "a,,Hips,1,2,3\n", "2:3", "pushes-value", "empty");
  wrong(head + "a,1,,1,2,3\n", "2:5", "pushes-value", "empty");
  wrong(head + "a,1,Hips,1,2,3\na,1,Hips,1,2,3\n", "3:1", "pushes-name", "line 2");
  wrong(head + "a,1,Wing,1,2,3\n", "2:5", "ragdoll-joint", "Wing");
  wrong(head + "a,99,Hips,1,2,3\n", "2:3", "ragdoll-time", "end");
  put("pushes.csv", kTable);
  refused({"walk.anim", "--pushes", "pushes.csv", "-o", "one.anim"}, "-o", "usage", "{name}");
  refused({"walk.anim", "--pushes", "pushes.csv", "--at", "1s", "-o", "{name}.anim"}, "--at",
          "usage", "exclude");
}

TEST_F(RagdollFiles, SavedBodiesGiveTheSameFall) {
  const json made = result({"walk.anim", "--at", "1s", "--duration", "1s", "--push",
                            "Spine2=90,0,20", "--save-bodies", "x.ragdoll.json", "-o", "a.anim"});
  const json read = result({"walk.anim", "--at", "1s", "--duration", "1s", "--push",
                            "Spine2=90,0,20", "--bodies", "x.ragdoll.json", "-o", "b.anim"});
  EXPECT_EQ(made["hash"], read["hash"]);
  // As meshes they are a valid glTF.
  result({"walk.anim", "--at", "1s", "--duration", "1s", "--save-bodies", "bodies.glb", "-o",
          "a.anim"});
  const auto judged =
      test::run({"/usr/bin/env", "node", test::source_folder() + "/tests/golden/validate_gltf.mjs",
                 path("bodies.glb")});
  EXPECT_EQ(judged.exit_code, 0) << judged.out << judged.err;
  refused({"walk.anim", "--bodies", "x.ragdoll.json", "--mass", "80kg", "-o", "c.anim"}, "--mass",
          "usage", "exclude each other");
  put("bad.ragdoll.json", "{\"schema\": \"krok.ragdoll/1\",\n \"bodies\": []}");
  refused({"walk.anim", "--bodies", "bad.ragdoll.json", "-o", "c.anim"}, "bad.ragdoll.json:2:12",
          "ragdoll-value", "0 bodies");
}

// As a character and the motions made for it in another program have them. Would fail if bodies
// were fitted to the vertices of other joints, or such a model were refused.
TEST_F(RagdollFiles, JointsOfAModelMayBeInAnotherOrder) {
  ASSERT_EQ(run_here("krok-body", {"walk.anim", "--detail", "low", "-o", "a.model"}).exit_code, 0);
  const auto file = InputFile::open(path("a.model"));
  auto model = model::read(file->bytes());
  ASSERT_TRUE(model.ok());
  // Children in the reverse order.
  const Skeleton& skeleton = model->skeleton;
  Skeleton other;
  const std::function<void(int, int)> add = [&](int joint, int parent) {
    const int self = other.add(skeleton.names[at(joint)], parent, skeleton.reference[at(joint)],
                               skeleton.end_sites[at(joint)] != 0);
    const auto below = skeleton.children()[at(joint)];
    for (auto child = below.rbegin(); child != below.rend(); ++child) add(*child, self);
  };
  add(0, -1);
  const auto bound = bind_to(*model, other);
  auto out = OutputFile::create(path("b.model"));
  ASSERT_TRUE(bound.ok() && model::write(*bound, {}, *out).ok() && out->commit().ok());
  for (const char* name : {"a", "b"}) {
    const auto run = fall({"walk.anim", "--at", "1s", "--duration", "1s", "--model",
                           name + std::string(".model"), "-o", name + std::string(".anim")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  EXPECT_EQ(run_here("krok-diff", {"a.anim", "b.anim"}).exit_code, 0);
}

}  // namespace
}  // namespace krok::test
