// Would fail if a glTF character, imported and skinned again by Krok's tools, showed other vertices
// than three.js shows of the original; or if Krok's own rigs did not come back as they were.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class ImportJudges : public CliTest {
 protected:
  void SetUp() override {
    const std::filesystem::path modules =
        std::filesystem::path(test::source_folder()) / "tests/node_modules/three";
    if (!std::filesystem::exists(modules)) {
      GTEST_SKIP() << "skipped: no " << modules.string() << "; run npm ci in tests/";
    }
  }

  void tool(const std::string& name, std::vector<std::string> arguments) const {
    const ToolRun run = run_tool(name, std::move(arguments));
    ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  }
  void judge(const std::string& a, const std::string& b, const std::string& tolerance) const {
    const ToolRun run_it =
        run({"/usr/bin/env", "node", test::source_folder() + "/tests/golden/three_bounds.mjs", a,
             "--against", b, "--every", "1", "--tolerance", tolerance});
    EXPECT_EQ(run_it.exit_code, 0) << run_it.out << run_it.err;
  }
};

TEST_F(ImportJudges, AForeignRigShowsTheSameVertices) {
  const std::string source = test::corpus_folder() + "/other/gltf/rigged_simple.gltf";
  if (!std::filesystem::exists(source)) GTEST_SKIP() << "skipped: no corpus at " << source;
  tool("krok-import", {source, "-o", path("a.anim"), "--save-model", path("a.model")});
  tool("krok-skin", {path("a.model"), path("a.anim"), "--as", "rig", "-o", path("a.glb")});
  // 9 m tall; its node transforms hold turns and an armature, its keys begin with the second frame.
  judge(path("a.glb"), source, "2e-5");
}

TEST_F(ImportJudges, AnOwnRigComesBack) {
  put("in.bvh", capture(40));
  tool("krok-import",
       {path("in.bvh"), "-o", path("a.anim"), "--unit", "m", "--up", "y", "--forward", "z"});
  tool("krok-body", {path("a.anim"), "-o", path("a.model"), "--detail", "low"});
  tool("krok-skin", {path("a.model"), path("a.anim"), "--as", "rig", "-o", path("rig.glb")});
  tool("krok-import", {path("rig.glb"), "-o", path("b.anim"), "--save-model", path("b.model")});
  tool("krok-diff", {path("a.anim"), path("b.anim"), "--tolerance", "0.01mm"});
  tool("krok-skin", {path("b.model"), path("b.anim"), "--as", "rig", "-o", path("again.glb")});
  judge(path("again.glb"), path("rig.glb"), "1e-5");
}

// Joints with scales of their own, against the bind pose and unlike along the axes: turning joints
// below them shear the mesh. Without the stretches of .anim this is centimetres off.
TEST_F(ImportJudges, ScaledJointsShowTheSameVertices) {
  put("in.bvh", capture(20));
  tool("krok-import", {path("in.bvh"), "-o", path("a.anim")});
  tool("krok-body", {path("a.anim"), "-o", path("a.model"), "--detail", "low"});
  tool("krok-skin", {path("a.model"), path("a.anim"), "--as", "rig", "-o", path("rig.gltf")});
  auto scene = nlohmann::json::parse(get(path("rig.gltf")));
  const auto joints = scene["skins"][0]["joints"];
  scene["nodes"][joints[0].get<std::size_t>()]["scale"] = {1, 0.9, 1.2};
  scene["nodes"][joints[2].get<std::size_t>()]["scale"] = {1.3, 1, 0.8};
  scene["nodes"][joints[joints.size() / 2].get<std::size_t>()]["scale"] = {1, 1.5, -1.1};
  put("scaled.gltf", scene.dump());
  tool("krok-import", {path("scaled.gltf"), "-o", path("b.anim"), "--save-model", path("b.model")});
  tool("krok-skin", {path("b.model"), path("b.anim"), "--as", "rig", "-o", path("b.glb")});
  judge(path("b.glb"), path("scaled.gltf"), "5e-5");
  // Baked by Krok's own skinning.
  tool("krok-skin", {path("b.model"), path("b.anim"), "-o", path("baked.glb")});
  judge(path("baked.glb"), path("scaled.gltf"), "5e-5");
  // A tool that works on rigid joints says that it does.
  const ToolRun edited =
      run_tool("krok-edit", {path("b.anim"), "--from", "2f", "-o", path("c.anim")});
  EXPECT_EQ(edited.exit_code, 0);
  EXPECT_NE(edited.err.find("[anim-stretch]"), std::string::npos) << edited.err;
}

TEST_F(ImportJudges, AnExportedMotionComesBackWithoutAMesh) {
  put("in.bvh", capture(40));
  tool("krok-import",
       {path("in.bvh"), "-o", path("a.anim"), "--unit", "m", "--up", "y", "--forward", "z"});
  tool("krok-export", {path("a.anim"), "--no-bones", "-o", path("a.glb")});
  tool("krok-import", {path("a.glb"), "-o", path("b.anim")});
  tool("krok-diff", {path("a.anim"), path("b.anim"), "--tolerance", "0.01mm"});
}

}  // namespace
}  // namespace krok::test
