// If these fail, files that show the same are said to differ, or what differs is not named.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "cli/krok_diff/target_a_frame.h"
#include "core/file.h"
#include "formats/anim/anim.h"
#include "formats/morph_exr/morph_exr.h"
#include "math/quaternion.h"
#include "support/folder_test.h"
#include "support/glb_builder.h"
#include "support/run_tool.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class KrokDiffMatching : public test::FolderTest {
 protected:
  test::ToolRun run(const std::string& tool, std::vector<std::string> arguments) {
    test::ToolOptions options;
    options.folder = folder_.string();
    arguments.insert(arguments.begin(), test::tools_folder() + "/" + tool);
    return test::run(arguments, options);
  }
  test::ToolRun diff(std::vector<std::string> arguments) {
    return run("krok-diff", std::move(arguments));
  }
  nlohmann::json result_of(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    return nlohmann::json::parse(diff(std::move(arguments)).out)["result"];
  }

  void write(const std::string& name, const test::GlbBuilder& builder) {
    const auto bytes = builder.glb();
    put(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  void write(const std::string& name, const Clip& clip) {
    auto file = OutputFile::create(path(name));
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(anim::write(clip, {}, *file).ok());
    ASSERT_TRUE(file->commit().ok());
  }
};

// A figure of three joints that turns, 600 frames long.
Clip three_joint_clip(const std::vector<std::string>& names = {"Hips", "Spine", "Head"}) {
  Clip clip;
  clip.rate = 60;
  for (int j = 0; j < 3; ++j) {
    clip.skeleton.add(names[static_cast<std::size_t>(j)], j - 1,
                      {Vec3(0, 1 + 0.4 * j, 0), Quat::Identity()});
  }
  clip.resize(600);
  for (int f = 0; f < 600; ++f) {
    std::vector<Transform> pose = clip.skeleton.reference;
    const Quat turn = from_rotation_vector(Vec3(0, 0.01 * f, 0));
    for (Transform& joint : pose) joint = {turn * joint.position, turn};
    clip.set_pose(f, pose);
  }
  return clip;
}

// A motion of 600 frames baked into the square's vertices: each frame a morph target, where the
// vertices lean a little further.
test::GlbBuilder baked(int lifted_vertex = -1, int lifted_frame = -1) {
  constexpr int kFrames = 600;
  test::GlbBuilder builder = test::square();
  nlohmann::ordered_json targets = nlohmann::ordered_json::array();
  for (int f = 1; f < kFrames; ++f) {
    std::vector<float> moved(12, 0.0F);
    for (std::size_t v = 0; v < 4; ++v) moved[3 * v] = 0.001F * static_cast<float>(f);
    if (f == lifted_frame) moved[static_cast<std::size_t>(3 * lifted_vertex + 2)] += 1e-4F;
    targets.push_back({{"POSITION", builder.add(moved, "VEC3")}});
  }
  builder.json["meshes"][0]["primitives"][0]["targets"] = targets;
  show_a_target_a_frame(kFrames, builder);
  return builder;
}

// Equal at all keys, and yet played otherwise: steps hold the last key, wild tangents leave the
// way.
TEST_F(KrokDiffMatching, WhatDiffersBetweenKeysIsFound) {
  write("linear.glb", test::rig());
  test::GlbBuilder steps = test::rig();
  steps.json["animations"][0]["samplers"][0]["interpolation"] = "STEP";
  write("steps.glb", steps);
  test::GlbBuilder spline = test::rig();
  const float eighth = 0.38268343F, eighth_cosine = 0.92387953F, quarter = 0.70710678F;
  std::vector<float> keys;
  for (const auto& [sine, cosine] :
       {std::pair(0.0F, 1.0F), {eighth, eighth_cosine}, {quarter, quarter}}) {
    for (const float value :
         {0.0F, 0.0F, 4.0F, 0.0F, 0.0F, 0.0F, sine, cosine, 0.0F, 0.0F, 4.0F, 0.0F})
      keys.push_back(value);
  }
  auto& sampler = spline.json["animations"][0]["samplers"][0];
  sampler["output"] = spline.add(keys, "VEC4");
  sampler["interpolation"] = "CUBICSPLINE";
  write("spline.glb", spline);
  for (const char* other : {"steps.glb", "spline.glb"}) {
    const auto done = diff({"linear.glb", other});
    EXPECT_EQ(done.exit_code, 1) << other << done.out;
    EXPECT_THAT(done.out, HasSubstr("linear interpolation in the first, "));
    EXPECT_EQ(diff({other, other}).exit_code, 0);
  }
  // From the last key to just before the next, 45 degrees on.
  const auto report = result_of({"linear.glb", "steps.glb"});
  EXPECT_NEAR(report["measures"][0]["largest"].get<double>(), 2 * std::sin(kPi / 8), 1e-5);
}

// An option is never skipped: with nearest points, materials are those of the points.
TEST_F(KrokDiffMatching, MaterialsOfNearestPointsAreCompared) {
  const auto two = [](double metallic) {
    test::GlbBuilder builder = test::square();
    builder.json["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", 0.5}}}},
                                 {{"pbrMetallicRoughness", {{"metallicFactor", metallic}}}}};
    auto& primitives = builder.json["meshes"][0]["primitives"];
    primitives[0]["material"] = 0;
    primitives.push_back(primitives[0]);
    primitives[1]["material"] = 1;
    // Above the first.
    std::vector<float> positions = test::square_positions();
    for (std::size_t v = 0; v < 4; ++v) positions[3 * v + 2] = 1;
    primitives[1]["attributes"]["POSITION"] = builder.add(positions, "VEC3");
    return builder;
  };
  test::GlbBuilder swapped = two(0.25);
  auto& primitives = swapped.json["meshes"][0]["primitives"];
  std::swap(primitives[0], primitives[1]);
  write("a.glb", two(0.25));
  write("b.glb", swapped);
  write("c.glb", two(0.75));
  EXPECT_EQ(diff({"a.glb", "b.glb", "--match", "nearest", "--materials"}).exit_code, 0);
  const auto done = diff({"a.glb", "c.glb", "--match", "nearest", "--materials"});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.out, HasSubstr("differs: mesh Body, primitive 1, material: metallic 0.25 and "
                                  "0.75"));
  EXPECT_EQ(diff({"a.glb", "c.glb", "--match", "nearest"}).exit_code, 0);
}

TEST_F(KrokDiffMatching, AVertexMovedByATenthOfAMillimetreInFrame37Of600IsFoundAndNamed) {
  write("golden.glb", baked());
  write("changed.glb", baked(3, 37));
  EXPECT_EQ(diff({"golden.glb", "golden.glb"}).exit_code, 0);
  const auto done = diff({"golden.glb", "changed.glb"});
  EXPECT_EQ(done.exit_code, 1) << done.err;
  EXPECT_THAT(done.out, HasSubstr("compared at 600 times"));
  EXPECT_THAT(done.out,
              HasSubstr("positions: largest 0.1 mm at vertex 3 of mesh Body, frame 37 (0.6167 s)"));
  EXPECT_THAT(done.out, HasSubstr("over tolerance in 1 of 2,400"));
  const auto near = diff({"golden.glb", "changed.glb", "--match", "nearest"});
  EXPECT_EQ(near.exit_code, 1);
  EXPECT_THAT(near.out,
              HasSubstr("largest at least 0.1 mm at vertex 3 of mesh Body, frame 37 (0.6167 s)"));
  EXPECT_EQ(diff({"golden.glb", "changed.glb", "--tolerance", "0.11mm"}).exit_code, 0);
  const auto report = result_of({"golden.glb", "changed.glb"});
  EXPECT_EQ(report["measures"][0]["percentile_95"], 0.0);
  EXPECT_EQ(report["meshes"][0]["mesh"], "Body");
  EXPECT_EQ(report["meshes"][0]["measures"][0]["where"]["frame"], 37);
}

TEST_F(KrokDiffMatching, JsonWithOtherOrderOfKeysProvenanceAndFloatNoiseIsTheSame) {
  test::GlbBuilder other = baked();
  nlohmann::ordered_json turned;
  for (auto it = other.json.rbegin(); it != other.json.rend(); ++it) turned[it.key()] = it.value();
  turned["asset"]["generator"] = "another program 2.0";
  turned["asset"]["extras"] = {{"krok", {{"tool", "krok-skin"}}}};
  other.json = turned;
  float x = 0;
  std::memcpy(&x, other.bin.data() + 12, 4);
  x = std::nextafter(x, 2.0F);
  std::memcpy(other.bin.data() + 12, &x, 4);
  write("a.glb", baked());
  write("b.glb", other);
  EXPECT_NE(get(path("a.glb")), get(path("b.glb")));
  const auto done = diff({"a.glb", "b.glb"});
  EXPECT_EQ(done.exit_code, 0) << done.out << done.err;
}

// The square with its corners in another order, and split into triangles of their own.
test::GlbBuilder other_square(bool split) {
  test::GlbBuilder builder;
  const std::vector<std::size_t> corners =
      split ? std::vector<std::size_t>{3, 0, 2, 1, 2, 0} : std::vector<std::size_t>{2, 0, 3, 1};
  std::vector<float> positions, normals;
  for (const std::size_t corner : corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      positions.push_back(test::square_positions()[3 * corner + k]);
      normals.push_back(test::square_normals()[3 * corner + k]);
    }
  }
  const auto indices = split ? std::vector<std::uint16_t>{0, 1, 2, 3, 4, 5}
                             : std::vector<std::uint16_t>{1, 3, 0, 2, 1, 0};
  builder.json["meshes"] = {{{"primitives",
                              {{{"attributes",
                                 {{"POSITION", builder.add(positions, "VEC3")},
                                  {"NORMAL", builder.add(normals, "VEC3")}}},
                                {"indices", builder.add(indices, "SCALAR")}}}}}};
  builder.json["nodes"] = {{{"name", "Body"}, {"mesh", 0}}};
  builder.json["scenes"] = {{{"nodes", {0}}}};
  return builder;
}

TEST_F(KrokDiffMatching, AReorderedMeshIsTheSameWithNearest) {
  write("a.glb", test::square());
  write("b.glb", other_square(false));
  write("c.glb", other_square(true));
  EXPECT_EQ(diff({"a.glb", "b.glb"}).exit_code, 1);
  EXPECT_EQ(diff({"a.glb", "c.glb"}).exit_code, 1);
  for (const char* other : {"b.glb", "c.glb"}) {
    const auto done = diff({"a.glb", other, "--match", "nearest"});
    EXPECT_EQ(done.exit_code, 0) << done.out << done.err;
    EXPECT_THAT(done.out, HasSubstr("positions: equal in all"));
  }
}

TEST_F(KrokDiffMatching, MeshesOfOtherNamesAreMatchedByOrderAndMissingOnesNamed) {
  test::GlbBuilder renamed = test::square();
  renamed.json["nodes"][0]["name"] = "Leib";
  write("a.glb", test::square());
  write("b.glb", renamed);
  EXPECT_EQ(diff({"a.glb", "b.glb"}).exit_code, 0);
  EXPECT_EQ(diff({"a.glb", "b.glb", "--match", "order"}).exit_code, 0);
  const auto named = diff({"a.glb", "b.glb", "--match", "name"});
  EXPECT_EQ(named.exit_code, 1);
  EXPECT_THAT(named.out, HasSubstr("only in the first: mesh Body"));
  EXPECT_THAT(named.out, HasSubstr("only in the second: mesh Leib"));
  const auto wrong = diff({"a.glb", "b.glb", "--match", "nearby"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("'nearby' is not auto, order, name or nearest"));
}

// Would fail if an engine that looks clips, meshes and materials up by name found none after an
// export that passed.
TEST_F(KrokDiffMatching, RenamedClipsMeshesAndMaterialsAreTold) {
  const auto named_rig = [](const char* clip, const char* material) {
    test::GlbBuilder builder = test::rig();
    builder.json["animations"][0]["name"] = clip;
    builder.json["materials"] = {{{"name", material}}};
    builder.json["meshes"][0]["primitives"][0]["material"] = 0;
    return builder;
  };
  write("a.glb", named_rig("walk", "skin"));
  write("clip.glb", named_rig("stroll", "skin"));
  write("material.glb", named_rig("walk", "hide"));
  const auto clip = diff({"a.glb", "clip.glb"});
  EXPECT_EQ(clip.exit_code, 1) << clip.out << clip.err;
  EXPECT_THAT(clip.out, HasSubstr("differs: animation walk is named stroll in the second"));
  test::GlbBuilder moved = named_rig("stroll", "skin");
  const auto root = moved.json["skins"][0]["joints"][0].get<std::size_t>();
  moved.json["nodes"][root]["translation"] = {0.1, 0, 0};
  write("moved.glb", moved);
  const auto both = diff({"a.glb", "moved.glb"});
  const std::size_t distance = both.out.find("  differs: positions 100 mm (10000 x the tolerance)");
  EXPECT_LT(distance, both.out.find("  differs: animation walk is named stroll")) << both.out;
  EXPECT_EQ(diff({"a.glb", "clip.glb", "--match", "order"}).exit_code, 0);
  EXPECT_EQ(diff({"a.glb", "material.glb"}).exit_code, 0);
  const auto material = diff({"a.glb", "material.glb", "--materials"});
  EXPECT_EQ(material.exit_code, 1) << material.out << material.err;
  EXPECT_THAT(material.out, HasSubstr("named skin and hide"));
  EXPECT_EQ(diff({"a.glb", "a.glb", "--materials", "--match", "name"}).exit_code, 0);
  test::GlbBuilder other_mesh = named_rig("walk", "skin");
  other_mesh.json["meshes"][0]["name"] = "Leib";
  write("mesh.glb", other_mesh);
  const auto mesh = diff({"a.glb", "mesh.glb"});
  EXPECT_EQ(mesh.exit_code, 0) << mesh.out;
  EXPECT_THAT(mesh.out, HasSubstr("is named Leib in the second"));
  EXPECT_EQ(diff({"a.glb", "mesh.glb", "--match", "name"}).exit_code, 1);
}

TEST_F(KrokDiffMatching, JointsAndNormalsHaveTolerancesOfTheirOwn) {
  Clip moved = three_joint_clip();
  for (int f = 0; f < 600; ++f) {
    moved.frame_positions(f)[2].y() += 2e-4F;
    Quatf& q = moved.frame_orientations(f)[1];
    q = (q.cast<double>() * from_rotation_vector(Vec3(0.1 * kRadiansPerDegree, 0, 0)))
            .cast<float>();
  }
  write("a.anim", three_joint_clip());
  write("b.anim", moved);
  const auto done = diff({"a.anim", "b.anim"});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.out, HasSubstr("joints beyond tolerance, 2 of 3:\n    joint Head: positions up "
                                  "to 0.2 mm, RMS 0.2 mm, 95 % 0.2 mm\n    joint Spine: "
                                  "orientations up to 0.101 deg, RMS 0.1 deg"));
  // Would fail if whoever gives a length were not shown the option for the angles that are left.
  EXPECT_THAT(done.out, HasSubstr("beyond tolerance (0.01 mm, 0.01 deg)\n"));
  EXPECT_THAT(diff({"a.anim", "b.anim", "--tolerance", "100mm"}).out,
              HasSubstr("(100 mm, 0.01 deg); --angle sets the tolerance of orientations\n"));
  EXPECT_EQ(diff({"a.anim", "b.anim", "--joint-tolerance", "0.3mm"}).exit_code, 1);
  const auto wide = diff({"a.anim", "b.anim", "--joint-tolerance", "0.3mm,0.2deg"});
  EXPECT_EQ(wide.exit_code, 0);
  EXPECT_THAT(wide.out, HasSubstr("within 0.01 mm, 0.01 deg, joints 0.3 mm and 0.2 deg\n"));
  EXPECT_EQ(
      diff({"a.anim", "b.anim", "--tolerance", "1m", "--angle", "1", "--joint-tolerance", "0.1mm"})
          .exit_code,
      1);
  test::GlbBuilder tilted = test::square();
  const double tilt = 1 * kRadiansPerDegree;
  const auto normals = tilted.json["accessors"][1]["bufferView"].get<std::size_t>();
  const auto offset = tilted.json["bufferViews"][normals]["byteOffset"].get<std::size_t>();
  const float normal[3] = {0, static_cast<float>(std::sin(tilt)),
                           static_cast<float>(std::cos(tilt))};
  std::memcpy(tilted.bin.data() + offset, normal, sizeof normal);
  write("a.glb", test::square());
  write("b.glb", tilted);
  EXPECT_EQ(diff({"a.glb", "b.glb"}).exit_code, 1);
  EXPECT_EQ(diff({"a.glb", "b.glb", "--normals", "1.1deg"}).exit_code, 0);
  EXPECT_EQ(diff({"a.glb", "b.glb", "--normals", "0.9deg", "--angle", "5"}).exit_code, 1);
  for (const char* option :
       {"--joint-tolerance=1mm,", "--joint-tolerance=,1", "--joint-tolerance=-1mm", "--normals=1mm",
        "--times=-1ms", "--times=3f", "--joint-tolerance=1mm,1deg,1"}) {
    const auto bad = diff({"a.anim", "a.anim", option});
    EXPECT_EQ(bad.exit_code, 2) << option;
    EXPECT_THAT(bad.err, HasSubstr("error: ")) << option;
  }
}

TEST_F(KrokDiffMatching, AMotionIsHeldAgainstItsBvhAndItsGlb) {
  write("walk.anim", three_joint_clip());
  ASSERT_EQ(run("krok-export", {"walk.anim", "-o", "walk.bvh"}).exit_code, 0);
  ASSERT_EQ(run("krok-export", {"walk.anim", "-o", "walk.glb"}).exit_code, 0);
  const auto bvh = diff({"walk.anim", "walk.bvh", "--joint-tolerance", "0.1mm,0.1deg"});
  EXPECT_THAT(bvh.out, HasSubstr("600 frames compared"));
  EXPECT_THAT(bvh.out, Not(HasSubstr("frames/s in the first")));
  const auto result = result_of({"walk.anim", "walk.bvh"});
  for (const auto& measure : result["measures"]) {
    // BVH holds no reference pose, so what stands there is made up.
    const std::string what = measure["what"];
    if (what == "positions" || what == "orientations") {
      EXPECT_EQ(measure["over"], 0) << what;
    }
  }
  const auto glb = diff({"walk.anim", "walk.glb"});
  EXPECT_EQ(glb.exit_code, 0) << glb.out << glb.err;
  EXPECT_THAT(glb.out, HasSubstr("joint positions: equal in all 1,800"));
  EXPECT_THAT(glb.out, HasSubstr("compared at 600 times"));
  Clip moved = three_joint_clip();
  moved.frame_positions(37)[2].x() += 1e-3F;
  write("moved.anim", moved);
  const auto found = diff({"moved.anim", "walk.glb"});
  EXPECT_EQ(found.exit_code, 1);
  EXPECT_THAT(found.out,
              HasSubstr("joint positions: largest 1 mm at joint Head, frame 37 (0.6167 s)"));
}

TEST_F(KrokDiffMatching, MorphTargetsInExrAreCompared) {
  MorphSet morphs;
  morphs.names = {"smile", "frown"};
  morphs.vertex_count = 3;
  for (int i = 0; i < 6; ++i) morphs.positions.emplace_back(0.1F * static_cast<float>(i), 1, 2);
  const auto write_exr = [&](const char* name) {
    auto file = OutputFile::create(path(name));
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(morph_exr::write(morphs, *file).ok());
    ASSERT_TRUE(file->commit().ok());
  };
  write_exr("a.exr");
  morphs.positions[4].z() += 0.002F;
  write_exr("b.exr");
  EXPECT_EQ(diff({"a.exr", "a.exr"}).exit_code, 0);
  const auto done = diff({"a.exr", "b.exr"});
  EXPECT_EQ(done.exit_code, 1) << done.err;
  EXPECT_THAT(done.out, HasSubstr("positions: largest 2 mm at vertex 1, target frown"));
  write("a.anim", three_joint_clip());
  const auto mixed = diff({"a.exr", "a.anim"});
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_THAT(mixed.err, HasSubstr("[diff-kinds]"));
}

TEST_F(KrokDiffMatching, OtherColoursAreToldAndWithMaterialsADifference) {
  const auto square = [](double metallic) {
    test::GlbBuilder builder = test::square();
    builder.json["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", metallic}}}}};
    builder.json["meshes"][0]["primitives"][0]["material"] = 0;
    return builder;
  };
  write("dull.glb", square(0.25));
  write("shiny.glb", square(1));
  const auto told = diff({"dull.glb", "shiny.glb"});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("note: mesh Body, material: metallic 0.25 and 1\n"));
  const auto strict = diff({"dull.glb", "shiny.glb", "--materials"});
  EXPECT_EQ(strict.exit_code, 1) << strict.err;
  EXPECT_THAT(strict.out, HasSubstr("differs: mesh Body, material: metallic 0.25 and 1\n"));
  EXPECT_EQ(diff({"dull.glb", "dull.glb", "--materials"}).exit_code, 0);
}

}  // namespace
}  // namespace krok::test
