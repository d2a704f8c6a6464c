// If these fail, the heatmap or the chart of a difference points at the wrong vertices or moments.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "cli/kept_files.h"
#include "formats/model/model_format.h"
#include "support/glb_builder.h"
#include "support/this_build.h"
#include "unit/gltf/glb.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class KrokDiffHeatmap : public CliTest {
 protected:
  std::string put_glb(const std::string& name, const GlbBuilder& builder) const {
    const auto bytes = builder.glb();
    return put(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  // The baked rig with corner 2 `off` metres further along z at its last key.
  static GlbBuilder moved(float off) {
    GlbBuilder builder = baked_rig();
    const auto& primitive = builder.json["meshes"][0]["primitives"][0];
    const auto accessor = primitive["targets"][1]["POSITION"].get<std::size_t>();
    const auto view = builder.json["accessors"][accessor]["bufferView"].get<std::size_t>();
    const auto offset =
        builder.json["bufferViews"][view]["byteOffset"].get<std::size_t>() + 2 * 12 + 8;
    std::memcpy(builder.bin.data() + offset, &off, 4);
    return builder;
  }
  // The file, by a reader that shares nothing with the writer.
  Glb glb(const std::string& name) const {
    Glb glb;
    glb.bytes = get(path(name));
    std::uint32_t json_size = 0;
    std::memcpy(&json_size, glb.bytes.data() + 12, 4);
    glb.json = nlohmann::json::parse(glb.bytes.substr(20, json_size));
    glb.data = glb.bytes.substr(28 + json_size);
    return glb;
  }
  // Which vertices are redder than all else.
  static std::vector<std::size_t> red_vertices(const Glb& glb) {
    const auto& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
    const auto colours = glb.values<float>(attributes["COLOR_0"]);
    std::vector<std::size_t> red;
    for (std::size_t v = 0; v < colours.size() / 3; ++v) {
      if (colours[3 * v] > 3 * colours[3 * v + 1]) red.push_back(v);
    }
    return red;
  }
};

TEST_F(KrokDiffHeatmap, ColoursTheVertexThatMovedWhereItMovedMost) {
  const std::string rig = put_glb("rig.glb", test::rig()), baked = put_glb("b.glb", moved(0.1F));
  const ToolRun run = run_tool("krok-diff", {rig, baked, "--heatmap", path("heat.glb")});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("grey up to 0.01 mm, then blue, yellow at "))
      << "the legend is said";
  const Glb heat = glb("heat.glb");
  EXPECT_THAT(red_vertices(heat), ElementsAre(2));
  EXPECT_EQ(heat.json["nodes"][0]["name"], "Body");
  EXPECT_EQ(heat.json["meshes"][0]["name"], "Square");
  // The rig as it stands at its last key, where corner 2 is at (0, 2, 0).
  const auto& attributes = heat.json["meshes"][0]["primitives"][0]["attributes"];
  const auto positions = heat.values<float>(attributes["POSITION"]);
  EXPECT_NEAR(positions[6], 0, 1e-6);
  EXPECT_NEAR(positions[7], 2, 1e-6);
  EXPECT_THAT(heat.json["materials"][0]["name"].get<std::string>(), HasSubstr("grey up to"));
}

TEST_F(KrokDiffHeatmap, TheSameIsGreyAllOver) {
  const std::string rig = put_glb("rig.glb", test::rig());
  const ToolRun run = run_tool("krok-diff", {rig, rig, "--heatmap", path("heat.glb")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(red_vertices(glb("heat.glb")), ElementsAre());
}

TEST_F(KrokDiffHeatmap, ColoursModels) {
  const auto file = InputFile::open(kFrozen + "full.model");
  ASSERT_TRUE(file.ok());
  auto model = model::read(file->bytes());
  ASSERT_TRUE(model.ok());
  const auto last = model->positions.size() - 1;
  model->positions[last].x() += 0.05F;
  auto other = OutputFile::create(path("other.model"));
  ASSERT_TRUE(other.ok() && model::write(*model, {}, *other).ok() && other->commit().ok());
  const ToolRun run = run_tool(
      "krok-diff", {kFrozen + "full.model", path("other.model"), "--heatmap", path("heat.glb")});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(red_vertices(glb("heat.glb")), ElementsAre(last));
}

TEST_F(KrokDiffHeatmap, TheKhronosValidatorFindsNothing) {
  const fs::path tests = fs::path(test::source_folder()) / "tests";
  if (!fs::exists(tests / "node_modules" / "gltf-validator")) {
    GTEST_SKIP() << "skipped: no gltf-validator in tests/node_modules; run npm ci in tests/";
  }
  const std::string rig = put_glb("rig.glb", test::rig()), baked = put_glb("b.glb", moved(0.1F));
  for (const char* name : {"heat.glb", "heat.gltf"}) {
    run_tool("krok-diff", {rig, baked, "--heatmap", path(name)});
  }
  const ToolRun judged =
      test::run({"/usr/bin/env", "node", (tests / "golden" / "validate_gltf.mjs").string(),
                 path("heat.glb"), path("heat.gltf")});
  EXPECT_EQ(judged.exit_code, 0) << judged.out << judged.err;
}

TEST_F(KrokDiffHeatmap, RefusesWhatHasNoMesh) {
  const std::string motion = kFrozen + "motion.anim", rig = put_glb("rig.glb", test::rig());
  EXPECT_EQ(run_tool("krok-diff", {motion, motion, "--heatmap", path("h.glb")}).exit_code, 2);
  EXPECT_EQ(run_tool("krok-diff", {rig, rig, "--heatmap", path("h.png")}).exit_code, 2);
  EXPECT_THAT(listing(), ElementsAre("rig.glb"));
}

TEST_F(KrokDiffHeatmap, PlotsGltfOverTime) {
  const std::string rig = put_glb("rig.glb", test::rig()), baked = put_glb("b.glb", moved(0.1F));
  const ToolRun run = run_tool("krok-diff", {rig, baked, "--plot", path("d.svg")});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  const std::string svg = get(path("d.svg"));
  EXPECT_THAT(svg, HasSubstr("Distance between vertices"));
  EXPECT_THAT(svg, HasSubstr("tolerance, "));
  EXPECT_THAT(svg, HasSubstr("largest, 1 s"));
  EXPECT_THAT(svg, Not(HasSubstr("joints"))) << "one of the two has none";
}

TEST_F(KrokDiffHeatmap, WhatStandsStillHasNoPlot) {
  const std::string square = put_glb("square.glb", test::square());
  const ToolRun run = run_tool("krok-diff", {square, square, "--plot", path("d.svg")});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.err, HasSubstr("[diff-plot]"));
  EXPECT_THAT(listing(), ElementsAre("square.glb"));
}

}  // namespace
}  // namespace krok::test
