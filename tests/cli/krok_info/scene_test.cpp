// If these fail, krok-info tells other joints, roles, units or sizes of a character's file than
// krok-import takes it for.

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "support/glb_builder.h"
#include "unit/assimp/sample_files.h"

namespace krok::test {
namespace {

using Json = nlohmann::ordered_json;

class InfoOfScenes : public CliTest {
 protected:
  std::string put_glb(const std::string& name, const GlbBuilder& builder) const {
    const auto bytes = builder.glb();
    return put(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  static Json info_of(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const ToolRun run = run_tool("krok-info", arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? Json::parse(run.out)["result"]["files"][0] : Json();
  }
};

TEST_F(InfoOfScenes, ACharactersJointsHaveRoles) {
  const std::string smd_file = put("a.smd", smd(MovingRig(), true, false));
  const ToolRun run = run_tool("krok-info", {smd_file, "-v"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("a.smd: a Valve SMD file\n"));
  EXPECT_THAT(run.out, HasSubstr("  joints   3\n"));
  EXPECT_THAT(run.out, HasSubstr("  no role  3 joints: Hips Spine Head\n"));
  EXPECT_THAT(run.out, HasSubstr("  roles    -                       Hips\n"));
  const Json file = info_of({smd_file});
  EXPECT_EQ(file["kind"], "smd");
  EXPECT_EQ(file["joints"], 3);
  EXPECT_EQ(file["unknown_joints"], (Json{"Hips", "Spine", "Head"}));
  EXPECT_EQ(file["skeleton"][2]["parent"], "Spine");
}

TEST_F(InfoOfScenes, AMapOverridesTheRolesFound) {
  put_glb("rig.glb", rig());
  put("map.json", R"({"joints": {"Root": "hips", "Tip": "head"}})");
  const Json file = info_of({path("rig.glb"), "--map", path("map.json")});
  EXPECT_EQ(file["roles"], (Json{{"hips", "Root"}, {"head", "Tip"}}));
  EXPECT_EQ(file["given_roles"], (Json{{"Root", "hips"}, {"Tip", "head"}}));
  EXPECT_EQ(file["unknown_joints"], Json::array());
  EXPECT_THAT(run_tool("krok-info", {path("rig.glb"), "--map", path("map.json")}).out,
              HasSubstr("as given    Root hips, Tip head\n"));
  put("map.json", R"({"joints": {"Tipp": "head"}})");
  const ToolRun wrong = run_tool("krok-info", {path("rig.glb"), "--map", path("map.json")});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("map.json:1:13: error:"));
  EXPECT_THAT(wrong.err, HasSubstr("did you mean \"Tip\"?"));
}

// COLLADA's example is in centimetres with +Z up; its corners span 0.5, 0.5 and 1.0 of them.
TEST_F(InfoOfScenes, SizesAreInMetresAndKroksAxes) {
  const Json file = info_of({put("a.dae", collada(MovingRig()))});
  EXPECT_EQ(file["kind"], "dae");
  // Assimp turns and scales by what the file says, into Y-up and metres.
  EXPECT_EQ(file["unit"]["metres"], 1.0);
  EXPECT_EQ(file["unit"]["confidence"], "certain");
  EXPECT_EQ(file["up"]["choice"], "y");
  EXPECT_NEAR(file["size"][0].get<double>(), 0.005, 1e-9);
  EXPECT_NEAR(file["height"].get<double>(), 0.01, 1e-9);
  EXPECT_NEAR(file["size"][2].get<double>(), 0.005, 1e-9);
  EXPECT_EQ(file["animations"].size(), 1u);
  EXPECT_EQ(file["cameras"][0]["name"], "eye");
}

// A baked clip: the node of a mesh whose shape changes is no joint. One that moves too may be.
TEST_F(InfoOfScenes, ANodeWhoseShapeAloneChangesIsNoJoint) {
  put("in.bvh", capture(5));
  run_tool("krok-import", {path("in.bvh"), "-o", path("in.anim")});
  run_tool("krok-body", {path("in.anim"), "--detail", "low", "-o", path("in.model")});
  const ToolRun baked = run_tool(
      "krok-skin", {path("in.model"), path("in.anim"), "--as", "baked", "-o", path("baked.gltf")});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  const Json file = info_of({path("baked.gltf")});
  EXPECT_EQ(file["meshes"][0]["morph_targets"], 4);
  EXPECT_FALSE(file.contains("joints"));
  EXPECT_FALSE(file.contains("skeleton"));
  const std::string told = run_tool("krok-info", {path("baked.gltf")}).out;
  EXPECT_THAT(told, Not(HasSubstr("joint")));

  Json scene = Json::parse(get(path("baked.gltf")));
  Json& animation = scene["animations"][0];
  // Times of the weights, and any three floats for each, as places.
  Json moves = animation["channels"][0];
  moves["target"]["path"] = "translation";
  moves["sampler"] = animation["samplers"].size();
  scene["accessors"].push_back({{"componentType", 5126}, {"count", 5}, {"type", "VEC3"}});
  animation["samplers"].push_back(
      {{"input", animation["samplers"][0]["input"]}, {"output", scene["accessors"].size() - 1}});
  animation["channels"].push_back(moves);
  put("moved.gltf", scene.dump());
  EXPECT_EQ(info_of({path("moved.gltf")})["joints"], 1);
}

TEST_F(InfoOfScenes, AThingWithoutASkeletonHasNoRoles) {
  put_glb("square.glb", square());
  const Json file = info_of({path("square.glb")});
  EXPECT_FALSE(file.contains("joints"));
  EXPECT_FALSE(file.contains("roles"));
  EXPECT_EQ(file["unit"]["choice"], "m");
  EXPECT_EQ(file["size"], (Json{1.0, 1.0, 0.0}));
  EXPECT_THAT(run_tool("krok-info", {path("square.glb")}).out, Not(HasSubstr("missing")));
}

// Would fail if a body's scale or its unit did not count, or an open mesh had a volume.
TEST_F(InfoOfScenes, ClosedMeshesHaveAVolume) {
  put_glb("square.glb", square());
  Json file = info_of({path("square.glb")});
  EXPECT_EQ(file["volumes"], (Json{{{"mesh", "Square"}, {"volume", nullptr}, {"area", 1.0}}}));
  EXPECT_THAT(run_tool("krok-info", {path("square.glb")}).out, Not(HasSubstr("volume")));

  // A corner of a cube with edges of 1 m, shown twice as large.
  GlbBuilder corner = square();
  auto& primitive = corner.json["meshes"][0]["primitives"][0];
  primitive["attributes"] = {
      {"POSITION", corner.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3")}};
  primitive["indices"] =
      corner.add(std::vector<std::uint16_t>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, "SCALAR");
  corner.json["nodes"][0]["scale"] = {2, 2, 2};
  put_glb("corner.glb", corner);
  file = info_of({path("corner.glb")});
  ASSERT_EQ(file["volumes"].size(), 1u);
  EXPECT_NEAR(file["volumes"][0]["volume"].get<double>(), 8.0 / 6, 1e-8);
  EXPECT_NEAR(file["volumes"][0]["area"].get<double>(), 6 + 2 * std::sqrt(3.0), 1e-8);
  EXPECT_THAT(run_tool("krok-info", {path("corner.glb")}).out,
              HasSubstr("  volume   Square: 1333 litres\n"));
}

TEST_F(InfoOfScenes, FilesReadBesideItAreInputsToo) {
  put("a.md5mesh", md5mesh(MovingRig()));
  put("a.md5anim", md5anim(MovingRig()));
  const ToolRun run = run_tool("krok-info", {path("a.md5anim"), "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const Json report = Json::parse(run.out);
  ASSERT_EQ(report["inputs"].size(), 2u);
  EXPECT_EQ(report["inputs"][1]["path"], path("a.md5mesh"));
  EXPECT_EQ(report["result"]["files"][0]["meshes"].size(), 1u);
}

TEST_F(InfoOfScenes, WhatIsReadThroughAssimpComesFromFilesAlone) {
  const std::string text = smd(MovingRig(), true, false);
  ToolOptions options;
  options.input = text;
  const ToolRun run = run_tool("krok-info", {"-"}, options);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "assimp-kind")) << run.err;
}

}  // namespace
}  // namespace krok::test
