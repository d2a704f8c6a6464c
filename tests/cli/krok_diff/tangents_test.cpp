// If these fail, a change of tangents, which normal maps show, passes CI, or a rig is said to
// differ from its own motion baked.

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/hero_character.h"
#include "cli/krok_diff/target_a_frame.h"
#include "math/transform.h"
#include "support/glb_builder.h"

namespace krok::test {
namespace {

// How a baked square differs from the others.
struct Change {
  int frame = -1;        // in which
  int vertex = -1;       // the tangent
  double turned = 0;     // is turned so far, radians
  bool flipped = false;  // all over, that of `vertex` is on the other side
  bool zero = false;     // and that of `vertex` is zero
};

constexpr int kFrames = 60;

// A square that leans as its tangents turn about Z, each frame of them a morph target.
GlbBuilder baked_bend(const Change& change = {}) {
  GlbBuilder builder = square();
  json targets = json::array();
  for (int f = 1; f < kFrames; ++f) {
    std::vector<float> moved, turned;
    for (int v = 0; v < 4; ++v) {
      const bool here = f == change.frame && v == change.vertex;
      const double angle = 0.01 * f + (here ? change.turned : 0);
      moved.insert(moved.end(), {0.001F * static_cast<float>(f), 0, 0});
      turned.insert(turned.end(), {static_cast<float>(std::cos(angle) - 1),
                                   static_cast<float>(std::sin(angle)), 0});
    }
    targets.push_back(
        {{"POSITION", builder.add(moved, "VEC3")}, {"TANGENT", builder.add(turned, "VEC3")}});
  }
  std::vector<float> tangents;
  for (int v = 0; v < 4; ++v) {
    const bool here = v == change.vertex;
    tangents.insert(tangents.end(), {here && change.zero ? 0.0F : 1.0F, 0, 0,
                                     here && change.flipped ? -1.0F : 1.0F});
  }
  auto& primitive = builder.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["TANGENT"] = builder.add(tangents, "VEC4");
  primitive["targets"] = targets;
  show_a_target_a_frame(kFrames, builder);
  return builder;
}

class DiffTangents : public CliTest {
 protected:
  void SetUp() override { write("golden.glb", baked_bend()); }

  void write(const std::string& name, const GlbBuilder& builder) {
    put(name, text_of(builder.glb()));
  }
  // Golden against another file.
  ToolRun diff(const std::string& other, std::vector<std::string> options = {}) {
    std::vector<std::string> arguments = {"golden.glb", other};
    arguments.insert(arguments.end(), options.begin(), options.end());
    ToolOptions here;
    here.folder = folder_.string();
    return run_tool("krok-diff", arguments, here);
  }
};

TEST_F(DiffTangents, TheSameFilesAreTheSame) {
  const ToolRun done = diff("golden.glb");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("tangents: equal in all 240\n"));
  EXPECT_THAT(done.out, HasSubstr("morph targets' tangents: equal in all 236\n"));
  EXPECT_THAT(done.out, Not(HasSubstr("handedness")));
}

TEST_F(DiffTangents, OneTurnedByADegreeInFrame37IsFoundAndNamed) {
  write("changed.glb", baked_bend({37, 2, kRadiansPerDegree}));
  for (const char* match : {"auto", "nearest"}) {
    const ToolRun done = diff("changed.glb", {"--match", match});
    EXPECT_EQ(done.exit_code, 1) << done.err;
    EXPECT_THAT(
        done.out,
        HasSubstr("tangents: largest 1 deg at vertex 2 of mesh Body, frame 37 (0.6167 s); RMS"));
    EXPECT_THAT(done.out, HasSubstr("normals: equal in all"));
    EXPECT_EQ(
        diff("changed.glb", {"--match", match, "--normals", "1.1deg", "--ratio", "1"}).exit_code,
        0);
  }
  const auto result = json::parse(diff("changed.glb", {"--json"}).out)["result"];
  const auto& mesh = result["meshes"][0]["measures"];
  ASSERT_EQ(mesh.size(), 3u);
  EXPECT_EQ(mesh[2]["what"], "tangents");
  EXPECT_EQ(mesh[2]["unit"], "deg");
  EXPECT_NEAR(mesh[2]["largest"].get<double>(), 1, 1e-4);
  EXPECT_EQ(mesh[2]["percentile_95"], 0.0);
  EXPECT_EQ(mesh[2]["over"], 1);
  EXPECT_EQ(mesh[2]["where"]["frame"], 37);
  EXPECT_EQ(result["measures"][2]["where"]["vertex"], 2);

  diff("changed.glb", {"--plot", "plot.svg"});
  EXPECT_THAT(get(path("plot.svg")), HasSubstr("Angle between tangents"));
}

TEST_F(DiffTangents, TheOtherHandednessIsNamed) {
  write("flipped.glb", baked_bend({.vertex = 3, .flipped = true}));
  // Nearest points are looked for both ways.
  for (const auto& [match, found] : {std::pair{"auto", "60 of 240"}, {"nearest", "120 of 480"}}) {
    const ToolRun done = diff("flipped.glb", {"--match", match, "--normals", "180deg"});
    EXPECT_EQ(done.exit_code, 1) << done.err;
    EXPECT_THAT(done.out, HasSubstr("handedness of tangents: flipped at vertex 3 of mesh "
                                    "Body, frame 0 (0 s); in " +
                                    std::string(found) + "\n"));
    EXPECT_THAT(done.out, HasSubstr("  tangents: equal in all "));
  }
  const auto result = json::parse(diff("flipped.glb", {"--json"}).out)["result"];
  EXPECT_EQ(result["measures"][3]["what"], "handedness of tangents");
  EXPECT_EQ(result["measures"][3]["over"], 60);
  EXPECT_EQ(result["measures"][3]["where"]["vertex"], 3);
  // In a folder's list it is what is told of the file.
  std::filesystem::create_directory(path("a"));
  std::filesystem::create_directory(path("b"));
  put("a/hero.glb", get(path("golden.glb")));
  put("b/hero.glb", get(path("flipped.glb")));
  ToolOptions here;
  here.folder = folder_.string();
  EXPECT_THAT(run_tool("krok-diff", {"a", "b"}, here).out,
              HasSubstr("handedness of tangents flipped at vertex 3 of mesh Body"));
}

TEST_F(DiffTangents, ATangentThatIsZeroIsFoundAndTheOthersAreStillCompared) {
  write("zero.glb", baked_bend({.vertex = 1, .zero = true}));
  const ToolRun done = diff("zero.glb");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.err, HasSubstr("1 of 4 tangents are zero, the first at vertex 1"));
  EXPECT_THAT(done.out, HasSubstr("tangents: largest 180 deg at vertex 1 of mesh Body, frame 0"));
}

TEST_F(DiffTangents, AFileWithoutThemIsToldAndADifferenceWhereANormalTextureNeedsThem) {
  const auto without = [](GlbBuilder builder) {
    auto& primitive = builder.json["meshes"][0]["primitives"][0];
    primitive["attributes"].erase("TANGENT");
    for (auto& target : primitive["targets"]) target.erase("TANGENT");
    return builder;
  };
  write("none.glb", without(baked_bend()));
  const ToolRun told = diff("none.glb");
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_THAT(told.out, HasSubstr("note: mesh Body: only the first has tangents, so they are not "
                                  "compared\n"));
  const auto bumpy = [](GlbBuilder builder) {
    const auto bytes = png();
    builder.json["images"] = {{{"bufferView", builder.add_view(bytes)}, {"mimeType", "image/png"}}};
    builder.json["textures"] = {{{"source", 0}}};
    builder.json["materials"] = {{{"normalTexture", {{"index", 0}}}}};
    builder.json["meshes"][0]["primitives"][0]["material"] = 0;
    return builder;
  };
  write("golden.glb", bumpy(baked_bend()));
  write("none.glb", bumpy(without(baked_bend())));
  const ToolRun shown = diff("none.glb");
  EXPECT_EQ(shown.exit_code, 1) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("differs: mesh Body: only the first has tangents, which normal "
                                   "textures need\n"));
}

// With krok-skin's own files, which have no tangents where the model has none: viewers make them.
class DiffBumpyHero : public HeroCharacter {};

TEST_F(DiffBumpyHero, ARigAgreesWithItsBakedClip) {
  put_material(R"("normal_texture": "skin.png")");
  put_character(kUpright);
  tool("krok-skin", {"hero.character", "in.anim", "--as", "rig", "-o", "rig.glb"});
  tool("krok-skin", {"hero.character", "in.anim", "--as", "baked", "-o", "clip.glb"});
  const ToolRun done = tool("krok-diff", {"rig.glb", "clip.glb"});
  EXPECT_EQ(done.exit_code, 0) << done.out;
  EXPECT_THAT(done.out, Not(HasSubstr("has tangents")));
  EXPECT_EQ(tool("krok-diff", {"rig.glb", "clip.glb", "--match", "nearest"}).exit_code, 0);
}

}  // namespace
}  // namespace krok::test
