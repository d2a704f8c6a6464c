// If these fail, krok-morph packs other shapes than it was given, puts them where other programs do
// not look for them, shows something else over time than its keys say, or leaves its user without
// knowing what is wrong.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "cli/judged_test.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "formats/pc2/pc2.h"
#include "support/test_scenes.h"

namespace krok::test {
namespace {

constexpr int kSide = 12;  // vertices

// A square sheet of quads, whose height is told by `height`.
std::string sheet(const std::function<double(double, double)>& height, int side = kSide) {
  std::string text = "o sheet\n";
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const double x = i / (side - 1.0) - 0.5, y = j / (side - 1.0) - 0.5;
      text += fmt::format("v {} {} {}\n", x, y, height(x, y));
    }
  }
  for (int j = 0; j + 1 < side; ++j) {
    for (int i = 0; i + 1 < side; ++i) {
      const int a = j * side + i + 1;
      text += fmt::format("f {} {} {} {}\n", a, a + 1, a + side + 1, a + side);
    }
  }
  return text;
}
double flat(double, double) {
  return 0;
}
double bump(double x, double y) {
  return 0.2 * std::exp(-20 * (x * x + y * y));
}
double wave(double x, double) {
  return 0.1 * std::sin(9 * x);
}

constexpr const char* kWeights =
    R"({"schema": "krok.weights/1", "rate": 20, "curves": [
  {"target": "bump", "keys": [[0, 0], [0.5, 1], [1, 0]]},
  {"target": "wave", "between": "smooth", "keys": [[0.5, 0], ["20f", 1]]}]})";

class KrokMorph : public JudgedTest {
 protected:
  KrokMorph()
      : base_(put("base.obj", sheet(flat))),
        bump_(put("bump.obj", sheet(bump))),
        wave_(put("wave.obj", sheet(wave))) {}

  ToolRun morph(std::vector<std::string> arguments) const {
    return run_tool("krok-morph", arguments);
  }
  json result_of(std::vector<std::string> arguments) const {
    arguments.push_back("--json");
    const ToolRun run = morph(std::move(arguments));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? json::parse(run.out)["result"] : json();
  }
  std::string packed() const {
    const ToolRun run = morph({"pack", base_, bump_, wave_, "-o", path("face.exr")});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return path("face.exr");
  }
  MorphSet morphs_at(const std::string& name) const {
    const std::string bytes = get(path(name));
    auto morphs = morph_exr::read(std::as_bytes(std::span(bytes)));
    EXPECT_TRUE(morphs.ok()) << name;
    return morphs ? *std::move(morphs) : MorphSet();
  }
  void refused(const std::vector<std::string>& arguments, const std::string& code,
               const std::string& words) const {
    const ToolRun run = morph(arguments);
    EXPECT_EQ(run.exit_code, 2) << run.err;
    EXPECT_TRUE(has_code(run.err, code)) << run.err;
    EXPECT_THAT(run.err, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(path("out.exr")));
    EXPECT_FALSE(std::filesystem::exists(path("out.glb")));
  }

  std::string base_, bump_, wave_;
};

TEST_F(KrokMorph, PacksShapesUnderTheNamesOfTheirFiles) {
  const json result = result_of({"pack", base_, bump_, wave_, "-o", path("face.exr")});
  EXPECT_EQ(result["vertices"], kSide * kSide);
  EXPECT_EQ(result["triangles"], 2 * (kSide - 1) * (kSide - 1));
  ASSERT_EQ(result["targets"].size(), 2u);
  EXPECT_EQ(result["targets"][0]["name"], "bump");
  // The highest vertex is one of the four beside the middle.
  const double off = 0.5 / (kSide - 1);
  EXPECT_NEAR(result["targets"][0]["largest_distance"].get<double>(), bump(off, off), 1e-6);
  EXPECT_EQ(result["targets"][0]["vertex"], kSide * (kSide / 2 - 1) + kSide / 2 - 1);

  const MorphSet morphs = morphs_at("face.exr");
  EXPECT_THAT(morphs.names, ElementsAre("bump", "wave"));
  EXPECT_EQ(morphs.provenance.tool, "krok-morph");
  ASSERT_EQ(morphs.provenance.sources.size(), 3u);
  EXPECT_EQ(morphs.provenance.sources[1].name, "bump.obj");
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const double x = i / (kSide - 1.0) - 0.5, y = j / (kSide - 1.0) - 0.5;
      const Vec3f expected = Vec3(x, y, wave(x, y)).cast<float>();
      EXPECT_EQ(morphs.target_positions(1)[static_cast<std::size_t>(j * kSide + i)], expected);
    }
  }
  // The surface z = h(x) has its normal along (-h', 0, 1); the mesh is coarse.
  const Vec3f normal = morphs.target_normals(1)[kSide * 5 + 6];
  const double x = 6 / (kSide - 1.0) - 0.5;
  EXPECT_LT((normal - Vec3(-0.9 * std::cos(9 * x), 0, 1).normalized().cast<float>()).norm(), 0.1f);
}

TEST_F(KrokMorph, NamesAndUnitsAreTheUsers) {
  const ToolRun run = morph({"pack", base_, bump_, wave_, "--name", "up, \"high\"", "--name",
                             "wavy", "--unit", "cm", "--up", "z", "-o", path("face.exr")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const MorphSet morphs = morphs_at("face.exr");
  EXPECT_THAT(morphs.names, ElementsAre("up, \"high\"", "wavy"));
  const double x = 1 / (kSide - 1.0) - 0.5;
  EXPECT_LT((morphs.target_positions(1)[1] -
             Vec3f(static_cast<float>(0.01 * x), static_cast<float>(0.01 * wave(x, 0)), 0.005f))
                .norm(),
            1e-7f);
}

TEST_F(KrokMorph, UnpackedShapesPackToTheSameTargets) {
  const std::string exr = packed();
  const MorphSet first = morphs_at("face.exr");
  for (const char* format : {"obj", "glb", "model"}) {
    const std::string folder = path(format);
    const ToolRun run = morph({"unpack", exr, base_, "--out-dir", folder, "--format", format});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const ToolRun again = morph({"pack", base_, folder + "/bump." + format,
                                 folder + "/wave." + format, "-o", path("again.exr")});
    ASSERT_EQ(again.exit_code, 0) << again.err;
    const MorphSet second = morphs_at("again.exr");
    EXPECT_EQ(second.names, first.names);
    EXPECT_EQ(second.positions, first.positions) << format;
  }
  // One alone, by its name, in the form of the base.
  const ToolRun one = morph({"unpack", exr, base_, "--out-dir", path("one"), "--target", "wave"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_TRUE(std::filesystem::exists(path("one/wave.obj")));
  EXPECT_FALSE(std::filesystem::exists(path("one/bump.obj")));
}

TEST_F(KrokMorph, ObjShapesComeBackInTheirUnitAndAxes) {
  const std::vector<std::string> space = {"--unit", "cm", "--up", "z"};
  std::vector<std::string> pack = {"pack", base_, bump_, "-o", path("face.exr")};
  std::vector<std::string> unpack = {"unpack", path("face.exr"), base_, "--out-dir", path("out")};
  pack.insert(pack.end(), space.begin(), space.end());
  unpack.insert(unpack.end(), space.begin(), space.end());
  ASSERT_EQ(morph(pack).exit_code, 0);
  ASSERT_EQ(morph(unpack).exit_code, 0);
  const std::string text = get(path("out/bump.obj"));
  const auto at = text.find("\nv ");
  ASSERT_NE(at, std::string::npos);
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(text.c_str() + at, " v %lf %lf %lf", &x, &y, &z), 3);
  EXPECT_NEAR(x, -0.5, 1e-6);
  EXPECT_NEAR(y, -0.5, 1e-6);
  EXPECT_NEAR(z, bump(0.5, 0.5), 1e-6);
}

TEST_F(KrokMorph, InfoTellsLayoutAndMovement) {
  const std::string exr = packed();
  const json alone = result_of({"info", exr});
  EXPECT_EQ(alone["vertices"], kSide * kSide);
  EXPECT_EQ(alone["normals"], true);
  EXPECT_EQ(alone["targets"][1]["first_texel"], kSide * kSide);
  EXPECT_FALSE(alone["targets"][1].contains("largest_distance"));
  const json width = alone["picture"]["width"], height = alone["picture"]["height"];
  EXPECT_GE(width.get<int>() * height.get<int>(), 4 * kSide * kSide);
  const json with_base = result_of({"info", exr, base_});
  double highest = 0;
  for (int i = 0; i < kSide; ++i) {
    highest = std::max(highest, std::abs(wave(i / (kSide - 1.0) - 0.5, 0)));
  }
  EXPECT_NEAR(with_base["targets"][1]["largest_distance"].get<double>(), highest, 1e-6);
  const ToolRun text = morph({"info", exr, base_});
  EXPECT_THAT(text.out, HasSubstr("2 targets of 144 vertices, with normals"));
  EXPECT_THAT(text.out, HasSubstr("bump: moves "));
}

// Other programs read the picture: three.js the texels, OpenEXR's own tool the header.
TEST_F(KrokMorph, OtherProgramsFindTheTargetsInTheImage) {
  const std::string exr = packed();
  judge({"three_morphs.mjs", "face.exr", "bump.obj", "wave.obj"});
  if (!std::filesystem::exists("/usr/bin/exrheader")) {
    GTEST_SKIP() << "skipped: no exrheader; install openexr";
  }
  const ToolRun run = test::run({"/usr/bin/exrheader", exr});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const char* part : {"R, 32-bit floating-point", "G, 32-bit floating-point",
                           "krokMorphVertices (type int): 144", "\"bump\"", "\"wave\""}) {
    EXPECT_THAT(run.out, HasSubstr(part));
  }
}

TEST_F(KrokMorph, AClipAndItsTargetsShowTheSame) {
  const std::string exr = packed(), weights = put("talk.json", kWeights);
  const json clip = result_of({"bake", exr, base_, "--weights", weights, "-o", path("clip.glb")});
  EXPECT_EQ(clip["frames"], 21);
  EXPECT_EQ(clip["rate"], 20);
  EXPECT_EQ(clip["targets"][0]["largest"], 1.0);
  for (const char* name : {"targets.glb", "targets.gltf"}) {
    const ToolRun run =
        morph({"bake", exr, base_, "--weights", weights, "--as", "targets", "-o", path(name)});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  judge({"validate_gltf.mjs", "clip.glb", "targets.glb", "targets.gltf"});
  judge({"three_bounds.mjs", "targets.glb", "--against", "clip.glb", "--every", "1", "--tolerance",
         "1e-6"});
}

TEST_F(KrokMorph, APointCacheHoldsTheFrames) {
  const std::string exr = packed(), weights = put("talk.json", kWeights);
  const ToolRun run =
      morph({"bake", exr, base_, "--weights", weights, "--rate", "2", "-o", path("talk.pc2")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string bytes = get(path("talk.pc2"));
  const auto cache = pc2::PointCache::read(std::as_bytes(std::span(bytes)));
  ASSERT_TRUE(cache.ok());
  ASSERT_EQ(cache->samples(), 3);
  ASSERT_EQ(cache->points(), kSide * kSide);
  std::vector<Vec3f> positions(kSide * kSide);
  ASSERT_TRUE(cache->get(1, positions).ok());
  // At half a second the bump shows alone and whole.
  const MorphSet morphs = morphs_at("face.exr");
  for (std::size_t v = 0; v < positions.size(); ++v) {
    EXPECT_EQ(positions[v], morphs.target_positions(0)[v]);
  }
}

TEST_F(KrokMorph, ATableOfWeightsIsTakenToo) {
  const std::string exr = packed();
  const std::string weights = put("w.csv", "frame,time,wave\n0,0,1\n1,0.1,0\n2,0.2,0.5\n");
  const json result = result_of({"bake", exr, base_, "--weights", weights, "-o", path("w.glb")});
  EXPECT_EQ(result["frames"], 3);
  EXPECT_EQ(result["rate"], 10);
  EXPECT_EQ(result["targets"][0]["largest"], 0);
}

TEST_F(KrokMorph, KeyShapesGoThroughTheirShapes) {
  const std::string keys = put("keys.json", R"({"schema": "krok.key-shapes/1", "rate": 10,
    "between": "hermite", "keys": [{"time": 0, "shape": "base.obj"},
    {"time": 0.4, "shape": "bump.obj"}, {"time": 1, "shape": "wave.obj"},
    {"time": "12f", "shape": "base.obj"}]})");
  const json result = result_of({"frames", keys, "-o", path("clip.glb")});
  EXPECT_EQ(result["keys"], 4);
  EXPECT_EQ(result["shapes"], 3);
  EXPECT_EQ(result["frames"], 13);
  ASSERT_EQ(morph({"frames", keys, "--as", "targets", "-o", path("targets.glb")}).exit_code, 0);
  ASSERT_EQ(
      morph({"frames", keys, "-o", path("keys.exr"), "--save-weights", path("w.csv")}).exit_code,
      0);
  ASSERT_EQ(
      morph({"bake", path("keys.exr"), base_, "--weights", path("w.csv"), "-o", path("baked.glb")})
          .exit_code,
      0);
  ASSERT_EQ(morph({"frames", keys, "-o", path("keys.pc2")}).exit_code, 0);
  const std::string bytes = get(path("keys.pc2"));
  const auto cache = pc2::PointCache::read(std::as_bytes(std::span(bytes)));
  ASSERT_TRUE(cache.ok());
  const MorphSet shapes = morphs_at("keys.exr");
  EXPECT_THAT(shapes.names, ElementsAre("base", "bump", "wave"));
  std::vector<Vec3f> positions(kSide * kSide);
  ASSERT_TRUE(cache->get(4, positions).ok());
  EXPECT_TRUE(std::ranges::equal(positions, shapes.target_positions(1)));
  ASSERT_TRUE(cache->get(12, positions).ok());
  EXPECT_TRUE(std::ranges::equal(positions, shapes.target_positions(0)));
  judge({"validate_gltf.mjs", "clip.glb", "targets.glb", "baked.glb"});
  judge({"three_bounds.mjs", "targets.glb", "--against", "clip.glb", "--every", "1", "--tolerance",
         "1e-6"});
  judge({"three_bounds.mjs", "baked.glb", "--against", "clip.glb", "--every", "1", "--tolerance",
         "1e-6"});
}

TEST_F(KrokMorph, AFolderIsTakenInTheOrderOfItsNumbers) {
  std::filesystem::create_directory(path("shapes"));
  put("shapes/s_10.obj", sheet(wave));
  put("shapes/s_2.obj", sheet(bump));
  put("shapes/s_1.obj", sheet(flat));
  put("shapes/notes.txt", "no shape");
  const json result = result_of(
      {"frames", path("shapes"), "--spacing", "0.5s", "--rate", "4", "-o", path("a.exr")});
  EXPECT_EQ(result["frames"], 5);
  EXPECT_EQ(result["between"], "linear");
  EXPECT_THAT(morphs_at("a.exr").names, ElementsAre("s_1", "s_2", "s_10"));
}

// Targets of a character with a skeleton, out of the file that they came in.
TEST_F(KrokMorph, TargetsWithinAGltfCharacterComeOut) {
  const std::string exr = packed(), weights = put("talk.json", kWeights);
  ASSERT_EQ(
      morph({"bake", exr, base_, "--weights", weights, "--as", "targets", "-o", path("face.glb")})
          .exit_code,
      0);
  const ToolRun run = morph({"pack", path("face.glb"), "-o", path("out_of_it.exr")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const MorphSet first = morphs_at("face.exr"), second = morphs_at("out_of_it.exr");
  EXPECT_EQ(second.names, first.names);
  ASSERT_EQ(second.positions.size(), first.positions.size());
  for (std::size_t v = 0; v < first.positions.size(); ++v) {
    EXPECT_LT((second.positions[v] - first.positions[v]).norm(), 1e-7f);
  }
}

TEST_F(KrokMorph, ThreadsChangeNoByte) {
  const std::string exr = packed(), weights = put("talk.json", kWeights);
  for (const char* as : {"clip", "targets"}) {
    for (const char* jobs : {"1", "4"}) {
      ASSERT_EQ(morph({"bake", exr, base_, "--weights", weights, "--as", as, "-j", jobs, "-o",
                       path(std::string(jobs) + ".glb")})
                    .exit_code,
                0);
    }
    EXPECT_EQ(get(path("1.glb")), get(path("4.glb"))) << as;
  }
}

TEST_F(KrokMorph, ShapesOfOtherMeshesAreRefused) {
  const std::string small = put("small.obj", sheet(flat, kSide - 1));
  refused({"pack", base_, bump_, small, "-o", path("out.exr")}, "morph-vertices",
          "small.obj: error: 121 vertices, but base.obj has 144");
  std::string other = get(bump_);
  const auto face = other.find("f 3 4 ");
  ASSERT_NE(face, std::string::npos);
  other.replace(face, 6, "f 3 5 ");
  const std::string odd = put("odd.obj", other);
  refused({"pack", base_, odd, "-o", path("out.exr")}, "morph-triangles",
          "odd.obj: error: triangle 4 (vertices 2, 4, 15");
  EXPECT_EQ(morph({"pack", base_, odd, "--match", "order", "-o", path("fine.exr")}).exit_code, 0);
  refused({"bake", packed(), small, "--weights", put("w.json", kWeights), "-o", path("out.glb")},
          "morph-vertices",
          "face.exr: error: the targets have 144 vertices, but small.obj has 121");
}

TEST_F(KrokMorph, FacesInAnotherOrderAreTheSameMesh) {
  std::string text = get(bump_);
  const auto first = text.find("f 1 2 14 13\n");
  ASSERT_NE(first, std::string::npos);
  text.erase(first, 12);
  text += "f 1 2 14 13\n";
  const ToolRun run = morph({"pack", base_, put("mixed.obj", text), "-o", path("out.exr")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST_F(KrokMorph, MistakesAreToldWithWhatToDo) {
  const std::string exr = packed();
  refused({"pack", base_, "-o", path("out.exr")}, "morph-target", "cannot have targets");
  refused({"pack", base_, bump_, bump_, "-o", path("out.exr")}, "morph-name",
          "duplicate target name");
  refused({"pack", base_, bump_, "--name", "a", "--name", "b", "-o", path("out.exr")}, "usage",
          "2 --names for 1 target file");
  refused({"pack", base_, bump_, "-o", path("out.glb")}, "morph-format", "writes .exr");
  refused({"pack", base_, bump_}, "usage", "no output given");
  refused({"pack", put("a.bvh", capture(2)), bump_, "-o", path("out.exr")}, "morph-input",
          "this is a BVH");
  refused({"unpack", exr, base_, "-o", path("out.exr")}, "usage", "--out-dir");
  refused({"unpack", exr, base_, "--out-dir", path("x"), "--target", "bumb"}, "morph-target",
          "did you mean 'bump'?");
  refused({"info", base_}, "exr-header", "base.obj");
  refused({"info", exr, "--weights", base_}, "usage", "--weights is for bake");
  refused({"bake", exr, base_, "-o", path("out.glb")}, "usage", "needs --weights");
  refused(
      {"bake", exr, base_, "--weights", put("w.csv", "time,bmup\n0,1\n"), "-o", path("out.glb")},
      "weights-target", "w.csv:1:6: error: there is no target 'bmup'");
  refused({"bake", exr, base_, "--weights", put("w.json", kWeights), "-o", path("out.obj")},
          "morph-format", ".pc2");
  refused(
      {"bake", exr, base_, "--weights", path("w.json"), "--rate", "100000", "-o", path("out.glb")},
      "morph-clip-too-long", "--as targets");
  refused({"frames", base_, "-o", path("out.glb")}, "morph-input", "single shape");
  refused({"frames", put("k.json", R"({"schema": "krok.key-shapes/1",
"keys": [{"time": 0, "shape": "base.obj"}, {"time": 0, "shape": "bump.obj"}]})"),
           "-o", path("out.glb")},
          "key-shapes-time", "k.json:2:53: error");
  refused({"frames", put("k.json", R"({"schema": "krok.key-shapes/1",
"keys": [{"time": 0, "shape": "../x.obj"}]})"),
           "-o", path("out.glb")},
          "key-shapes-path", "k.json:2:31: error");
  refused({"frames", base_, "--tension", "2", "-o", path("out.glb")}, "usage", "--tension");
  refused({"pack", base_, bump_, "-o", base_}, "morph-format", "base.obj");
}

}  // namespace
}  // namespace krok::test
