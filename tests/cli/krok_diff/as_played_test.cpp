// If these fail, files that a viewer shows alike are said to differ, files that it shows
// differently are said to be the same, or something is left out of a comparison without a word.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "math/transform.h"
#include "support/folder_test.h"
#include "support/glb_builder.h"
#include "support/run_tool.h"
#include "support/small_images.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

class KrokDiffAsPlayed : public FolderTest {
 protected:
  ToolRun diff(std::vector<std::string> arguments) {
    ToolOptions options;
    options.folder = folder_.string();
    arguments.insert(arguments.begin(), test::tools_folder() + "/krok-diff");
    return run(arguments, options);
  }
  nlohmann::json report_of(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    return nlohmann::json::parse(diff(std::move(arguments)).out);
  }
  // The largest difference of a quantity; -1 if it was not compared.
  double largest(std::vector<std::string> arguments, const std::string& what) {
    const auto report = report_of(std::move(arguments));
    for (const auto& measure : report["result"]["measures"]) {
      if (measure["what"] == what) return measure["largest"];
    }
    return -1;
  }
  void write(const std::string& name, const GlbBuilder& builder) {
    put(name, text_of(builder.glb()));
  }
};

Json& primitive_of(GlbBuilder& builder) {
  return builder.json["meshes"][0]["primitives"][0];
}

// One animation of one property of node 0.
void animate(GlbBuilder& builder, const char* path, const std::vector<float>& times,
             const std::vector<float>& values, const char* type,
             const char* interpolation = "LINEAR") {
  builder.json["animations"] = {
      {{"name", "Move"},
       {"samplers",
        {{{"input", builder.add(times, "SCALAR")},
          {"output", builder.add(values, type)},
          {"interpolation", interpolation}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
}

// Values v0, v1 with tangents: (in, value, out) of each key.
std::vector<float> spline(float out_tangent) {
  return {0, 0, 0, 0, 0, 0, out_tangent, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
}

// The square rests, or leaves its place by 521 mm between two keys that are the same: the Hermite
// basis t (1 - t)^2 has its largest value, 4/27, at a third. The page promises at least 1 / 1.1 of
// that, for a spline that vanishes at its keys.
TEST_F(KrokDiffAsPlayed, WildTangentsAreFoundToATenth) {
  GlbBuilder rest = square(), wild = square();
  animate(rest, "translation", {0, 1}, {0, 0, 0, 0, 0, 0}, "VEC3");
  animate(wild, "translation", {0, 1}, spline(0.521F * 27 / 4), "VEC3", "CUBICSPLINE");
  write("rest.glb", rest);
  write("wild.glb", wild);
  EXPECT_EQ(diff({"rest.glb", "wild.glb"}).exit_code, 1);
  const double found = largest({"rest.glb", "wild.glb"}, "positions");
  EXPECT_LE(found, 0.5211);
  EXPECT_GE(found, 0.521 / 1.1);
  EXPECT_EQ(diff({"wild.glb", "wild.glb"}).exit_code, 0);
  // A spline that is straight is the same as a line, and that it is a spline is reported.
  GlbBuilder line = square(), straight = square();
  animate(line, "translation", {0, 1}, {0, 0, 0, 2, 0, 0}, "VEC3");
  animate(straight, "translation", {0, 1}, {0, 0, 0, 0, 0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 0, 0, 0},
          "VEC3", "CUBICSPLINE");
  write("line.glb", line);
  write("straight.glb", straight);
  const auto same = diff({"line.glb", "straight.glb"});
  EXPECT_EQ(same.exit_code, 0) << same.out;
  EXPECT_THAT(same.out, HasSubstr("note: animation Move: linear interpolation in the first, cubic "
                                  "spline in the second"));
}

// A step holds its value up to the next key; just before, it is as far off as it gets. A viewer
// shows that: it is no matter of a quarter or three.
TEST_F(KrokDiffAsPlayed, StepsAreAsFarOffAsJustBeforeTheNextKey) {
  GlbBuilder line = square(), step = square();
  animate(line, "translation", {0, 1}, {0, 0, 0, 0.103F, 0, 0}, "VEC3");
  animate(step, "translation", {0, 1}, {0, 0, 0, 0.103F, 0, 0}, "VEC3", "STEP");
  write("line.glb", line);
  write("step.glb", step);
  EXPECT_EQ(diff({"line.glb", "step.glb"}).exit_code, 1);
  EXPECT_NEAR(largest({"line.glb", "step.glb"}, "positions"), 0.103, 1e-6);
  const auto out = diff({"line.glb", "step.glb"}).out;
  EXPECT_THAT(out, HasSubstr("linear interpolation in the first, step in the second"));
  EXPECT_THAT(out, HasSubstr("after frame 0 (1 s)"));
}

// Half a turn less or more than a hair goes round the other way: equal within a tolerance at the
// keys, and 180 degrees apart between them.
TEST_F(KrokDiffAsPlayed, TurnsTheOtherWayRoundAreFound) {
  const auto turned = [](double degrees) {
    GlbBuilder builder = square();
    const double half = 0.5 * degrees * kRadiansPerDegree;
    animate(
        builder, "rotation", {0, 1},
        {0, 0, 0, 1, 0, static_cast<float>(std::sin(half)), 0, static_cast<float>(std::cos(half))},
        "VEC4");
    return builder;
  };
  write("less.glb", turned(179.9));
  write("more.glb", turned(180.1));
  const auto found = diff({"less.glb", "more.glb", "--tolerance", "1cm", "--angle", "1deg"});
  EXPECT_EQ(found.exit_code, 1);
  EXPECT_THAT(found.out, HasSubstr("positions: largest 2000 mm"));
}

// Frames are those of the first file, whatever keys the second has.
TEST_F(KrokDiffAsPlayed, FramesAreTheFirstFilesOwn) {
  GlbBuilder few = square(), many = square();
  animate(few, "translation", {0, 0.5F, 1}, {0, 0, 0, 0.5F, 0, 0, 1, 0, 0}, "VEC3");
  animate(many, "translation", {0, 0.1F, 0.2F, 0.5F, 0.75F, 1},
          {0, 0, 0, 0.1F, 0, 0, 0.2F, 0, 0, 0.5F, 0, 0, 0.75F, 0, 0, 1.25F, 0, 0}, "VEC3");
  write("few.glb", few);
  write("many.glb", many);
  EXPECT_THAT(diff({"few.glb", "many.glb"}).out, HasSubstr("of mesh Body, frame 2 (1 s)"));
  const auto where = report_of({"few.glb", "many.glb"})["result"]["measures"][0]["where"];
  EXPECT_EQ(where["frame"], 2);
  EXPECT_EQ(where["node_name"], "Body");
  EXPECT_EQ(where["mesh_name"], "Square");
  // Between its frames: at the second's key, three quarters on.
  GlbBuilder bump = square();
  animate(bump, "translation", {0, 0.5F, 0.75F, 1}, {0, 0, 0, 0.5F, 0, 0, 0.9F, 0, 0, 1, 0, 0},
          "VEC3");
  write("bump.glb", bump);
  EXPECT_THAT(diff({"few.glb", "bump.glb"}).out, HasSubstr("after frame 1 (0.75 s)"));
}

// A square with a morph target; positions and displacements divided by `scale`, which its node
// multiplies again: what quantising does. `more` is added to a displacement, in metres.
GlbBuilder morphed(float scale, float more = 0, bool skinned = false) {
  GlbBuilder builder;
  std::vector<float> positions = square_positions(), moved(12, 0.0F);
  moved[8] = 0.25F + more;  // corner 2 along z
  for (float& value : positions) value /= scale;
  for (float& value : moved) value /= scale;
  Json attributes = {{"POSITION", builder.add(positions, "VEC3")},
                     {"NORMAL", builder.add(square_normals(), "VEC3")}};
  if (skinned) {
    attributes["JOINTS_0"] = builder.add(std::vector<std::uint8_t>(16, 0), "VEC4");
    std::vector<float> weights(16, 0.0F);
    for (std::size_t v = 0; v < 4; ++v) weights[4 * v] = 1;
    attributes["WEIGHTS_0"] = builder.add(weights, "VEC4");
    std::vector<float> bind(16, 0.0F);
    bind[0] = bind[5] = bind[10] = scale;
    bind[15] = 1;
    builder.json["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", builder.add(bind, "MAT4")}}};
  }
  const int indices = builder.add(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR");
  builder.json["meshes"] = {{{"primitives",
                              {{{"attributes", attributes},
                                {"indices", indices},
                                {"targets", {{{"POSITION", builder.add(moved, "VEC3")}}}}}}}}};
  builder.json["nodes"] = {{{"name", "Body"}, {"mesh", 0}}, {{"name", "Root"}}};
  if (skinned) {
    builder.json["nodes"][0]["skin"] = 0;
  } else {
    builder.json["nodes"][0]["scale"] = {scale, scale, scale};
  }
  builder.json["scenes"] = {{{"nodes", {0, 1}}}};
  return builder;
}

TEST_F(KrokDiffAsPlayed, MorphTargetsAreComparedInMetresOfTheWorld) {
  for (const bool skinned : {false, true}) {
    write("plain.glb", morphed(1, 0, skinned));
    write("small.glb", morphed(0.001F, 0, skinned));
    write("off.glb", morphed(0.001F, 0.00184F, skinned));
    const auto same = diff({"plain.glb", "small.glb"});
    EXPECT_EQ(same.exit_code, 0) << same.out;
    EXPECT_EQ(diff({"plain.glb", "off.glb"}).exit_code, 1);
    EXPECT_NEAR(largest({"plain.glb", "off.glb"}, "morph targets"), 0.00184, 1e-7);
    EXPECT_EQ(diff({"plain.glb", "off.glb", "--tolerance", "2mm"}).exit_code, 0);
  }
}

// The same motion baked into two targets, and into three: only what they show counts. Where names
// are shared, a target is lost.
TEST_F(KrokDiffAsPlayed, BakesWithOtherNumbersOfTargetsAreComparedByPositions) {
  write("two.glb", baked_rig());
  GlbBuilder three = baked_rig();
  auto& targets = primitive_of(three)["targets"];
  targets.push_back(targets[0]);
  three.json["meshes"][0]["extras"] = {{"targetNames", {"a", "b", "c"}}};
  auto& sampler = three.json["animations"][0]["samplers"][0];
  sampler["output"] = three.add(std::vector<float>{0, 0, 0, 0, 0, 1, 0, 1, 0}, "SCALAR");
  write("three.glb", three);
  const auto same = diff({"two.glb", "three.glb"});
  EXPECT_EQ(same.exit_code, 0) << same.out;
  EXPECT_THAT(same.out,
              HasSubstr("2 morph targets in the first, 3 in the second; compared by their "
                        "effect only"));
  EXPECT_EQ(diff({"two.glb", "three.glb", "--match", "name"}).exit_code, 1);
  three.json["meshes"][0]["extras"] = {{"targetNames", {"half", "full", "smile"}}};
  write("lost.glb", three);
  EXPECT_EQ(diff({"two.glb", "lost.glb"}).exit_code, 1);
}

// A square under a node that mirrors at x = 0, or the same with its vertices mirrored themselves.
// By glTF 2.0, section 3.7.4, a mirroring node turns the winding round.
GlbBuilder mirrored(bool by_node, bool turned) {
  GlbBuilder builder;
  std::vector<float> positions = square_positions();
  for (std::size_t v = 0; v < 4 && !by_node; ++v) positions[3 * v] *= -1;
  const std::vector<std::uint16_t> forward = {0, 1, 2, 0, 2, 3}, back = {0, 2, 1, 0, 3, 2};
  const int indices = builder.add(turned ? back : forward, "SCALAR");
  builder.json["meshes"] = {{{"primitives",
                              {{{"attributes",
                                 {{"POSITION", builder.add(positions, "VEC3")},
                                  {"NORMAL", builder.add(square_normals(), "VEC3")}}},
                                {"indices", indices}}}}}};
  builder.json["nodes"] = {{{"name", "Body"}, {"mesh", 0}}};
  if (by_node) builder.json["nodes"][0]["scale"] = {-1, 1, 1};
  builder.json["scenes"] = {{{"nodes", {0}}}};
  return builder;
}

// Exporters give a face's targets to the eyes, too. Would fail if leaving out what moves nothing
// were a difference, or if what moves were passed over.
TEST_F(KrokDiffAsPlayed, TargetsThatMoveNothingMayBeLeftOut) {
  const auto with_target = [](float height) {
    GlbBuilder builder = mirrored(false, false);
    std::vector<float> displacements(12, 0.0f);
    displacements[1] = height;
    primitive_of(builder)["targets"] = {{{"POSITION", builder.add(displacements, "VEC3")}}};
    return builder;
  };
  write("none.glb", mirrored(false, false));
  write("still.glb", with_target(0));
  write("moves.glb", with_target(0.01f));
  for (const auto& [first, second] :
       {std::pair("none.glb", "still.glb"), {"still.glb", "none.glb"}}) {
    const auto same = diff({first, second});
    EXPECT_EQ(same.exit_code, 0) << same.out;
    EXPECT_THAT(same.out, HasSubstr("which move nothing"));
  }
  EXPECT_EQ(diff({"none.glb", "moves.glb"}).exit_code, 1);
  EXPECT_EQ(diff({"moves.glb", "none.glb"}).exit_code, 1);
}

TEST_F(KrokDiffAsPlayed, MirroringNodesTurnTheWinding) {
  write("node.glb", mirrored(true, false));
  write("baked.glb", mirrored(false, true));
  write("inside_out.glb", mirrored(false, false));
  for (const char* how : {"auto", "nearest"}) {
    const auto same = diff({"node.glb", "baked.glb", "--match", how});
    EXPECT_EQ(same.exit_code, 0) << how << same.out;
    for (const char* other : {"node.glb", "baked.glb"}) {
      const auto found = diff({other, "inside_out.glb", "--match", how});
      EXPECT_EQ(found.exit_code, 1) << how << found.out;
      EXPECT_THAT(found.out, HasSubstr("inside out")) << how;
      EXPECT_THAT(found.out, HasSubstr("positions: equal")) << how;
    }
  }
}

// A node that begins to mirror when the other does not, with vertices that are placed alike.
TEST_F(KrokDiffAsPlayed, NodesThatMirrorLaterAreFound) {
  // Flat at x = 0, so that mirroring moves nothing.
  GlbBuilder rests;
  const std::vector<float> positions = {0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1};
  rests.json["meshes"] = {
      {{"primitives",
        {{{"attributes", {{"POSITION", rests.add(positions, "VEC3")}}},
          {"indices", rests.add(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR")}}}}}};
  rests.json["nodes"] = {{{"name", "Body"}, {"mesh", 0}}};
  rests.json["scenes"] = {{{"nodes", {0}}}};
  GlbBuilder mirrors = rests;
  animate(rests, "scale", {0, 1}, {1, 1, 1, 1, 1, 1}, "VEC3");
  animate(mirrors, "scale", {0, 1}, {1, 1, 1, -1, 1, 1}, "VEC3");
  write("rests.glb", rests);
  write("mirrors.glb", mirrors);
  const auto found = diff({"rests.glb", "mirrors.glb"});
  EXPECT_EQ(found.exit_code, 1);
  EXPECT_THAT(found.out, HasSubstr("turned inside out in only one of the two at 1 s"));
}

GlbBuilder coloured(const std::vector<float>& colours) {
  GlbBuilder builder = square();
  primitive_of(builder)["attributes"]["COLOR_0"] = builder.add(colours, "VEC4");
  return builder;
}

TEST_F(KrokDiffAsPlayed, VertexColoursCountWithMaterials) {
  const std::vector<float> red = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1};
  std::vector<float> other = red;
  other[9] = 0.5F;
  write("red.glb", coloured(red));
  write("other.glb", coloured(other));
  write("none.glb", square());
  write("white.glb", coloured(std::vector<float>(16, 1.0F)));  // looks like none
  GlbBuilder bytes = square();
  primitive_of(bytes)["attributes"]["COLOR_0"] = bytes.add(
      std::vector<std::uint8_t>{255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255},
      "VEC4", true);
  write("bytes.glb", bytes);
  for (const char* how : {"auto", "nearest"}) {
    EXPECT_EQ(diff({"red.glb", "bytes.glb", "--materials", "--match", how}).exit_code, 0) << how;
    const auto quiet = diff({"red.glb", "other.glb", "--match", how});
    EXPECT_EQ(quiet.exit_code, 0) << how;
    EXPECT_THAT(quiet.out, HasSubstr("vertex colours differ")) << how;
    EXPECT_THAT(quiet.out, HasSubstr("vertex colours: largest 0.5 at vertex 2 of mesh Body"))
        << how;
    EXPECT_EQ(diff({"red.glb", "other.glb", "--materials", "--match", how}).exit_code, 1) << how;
    EXPECT_THAT(diff({"red.glb", "none.glb", "--match", how}).out,
                HasSubstr("only the first has vertex colours"));
    EXPECT_EQ(diff({"red.glb", "none.glb", "--materials", "--match", how}).exit_code, 1) << how;
    EXPECT_EQ(diff({"white.glb", "none.glb", "--materials", "--match", how}).exit_code, 0) << how;
  }
}

// A square with one material that has a texture; `change` alters the material.
GlbBuilder textured(const std::function<void(Json&)>& change,
                    const std::vector<float>& coordinates = {0, 0, 1, 0, 1, 1, 0, 1}) {
  GlbBuilder builder = square();
  const int accessor = builder.add(coordinates, "VEC2");
  primitive_of(builder)["attributes"]["TEXCOORD_0"] = accessor;
  builder.json["images"] = {{{"bufferView", builder.add_view(png())}, {"mimeType", "image/png"}}};
  builder.json["textures"] = {{{"source", 0}}};
  Json material = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};
  change(material);
  builder.json["materials"] = Json::array({material});
  primitive_of(builder)["material"] = 0;
  return builder;
}

TEST_F(KrokDiffAsPlayed, FurtherTextureCoordinatesAreCompared) {
  const auto with_second = [](float last, bool used) {
    GlbBuilder builder = textured([used](Json& material) {
      if (used) material["occlusionTexture"] = {{"index", 0}, {"texCoord", 1}};
    });
    primitive_of(builder)["attributes"]["TEXCOORD_1"] =
        builder.add(std::vector<float>{0, 0, 1, 0, 1, 1, 0, last}, "VEC2");
    return builder;
  };
  write("two.glb", with_second(1, false));
  write("moved.glb", with_second(0.9F, false));
  write("one.glb", textured([](Json&) {}));
  const auto moved = diff({"two.glb", "moved.glb"});
  EXPECT_EQ(moved.exit_code, 1) << moved.out;
  EXPECT_THAT(moved.out, HasSubstr("texture coordinates: largest 0.1 at vertex 3"));
  const auto unused = diff({"two.glb", "one.glb"});
  EXPECT_EQ(unused.exit_code, 0) << unused.out;
  EXPECT_THAT(unused.out, HasSubstr("note: mesh Body: only the first has texture coordinates 1, "
                                    "which no texture uses"));
  EXPECT_EQ(diff({"two.glb", "one.glb", "--materials"}).exit_code, 1);
  write("used.glb", with_second(1, true));
  GlbBuilder lost = with_second(1, true);
  primitive_of(lost)["attributes"].erase("TEXCOORD_1");
  write("lost.glb", lost);
  EXPECT_EQ(diff({"used.glb", "lost.glb"}).exit_code, 1);
  // The occlusion of a further set is not in a .material, but it is compared.
  EXPECT_EQ(diff({"used.glb", "two.glb"}).exit_code, 0);
  EXPECT_EQ(diff({"used.glb", "two.glb", "--materials"}).exit_code, 1);
}

TEST_F(KrokDiffAsPlayed, ExtensionsOfMaterialsAreComparedWithTheirDefaults) {
  const auto coat = [](Json values) {
    return textured([values](Json& material) {
      material["extensions"] = {{"KHR_materials_clearcoat", values}};
    });
  };
  write("none.glb", textured([](Json&) {}));
  write("zero.glb", coat({{"clearcoatFactor", 0.0}}));
  write("half.glb", coat({{"clearcoatFactor", 0.5}}));
  write("mapped.glb", coat({{"clearcoatFactor", 0.5}, {"clearcoatTexture", {{"index", 0}}}}));
  for (const char* how : {"auto", "nearest"}) {
    EXPECT_EQ(diff({"none.glb", "zero.glb", "--materials", "--match", how}).exit_code, 0);
    const auto found = diff({"none.glb", "half.glb", "--materials", "--match", how});
    EXPECT_EQ(found.exit_code, 1) << found.out;
    EXPECT_THAT(found.out, HasSubstr("KHR_materials_clearcoat, clearcoatFactor 0 and 0.5"));
    EXPECT_EQ(diff({"none.glb", "half.glb", "--match", how}).exit_code, 0);
    EXPECT_THAT(diff({"half.glb", "mapped.glb", "--materials", "--match", how}).out,
                HasSubstr("only the second has a KHR_materials_clearcoat, clearcoatTexture"));
  }
  // What is compared is not said to be ignored.
  EXPECT_EQ(diff({"half.glb", "half.glb"}).err, "");
}

// Coordinates of half the size and a transform that doubles them show the same; a transform alone
// does not.
TEST_F(KrokDiffAsPlayed, TextureTransformsAreAppliedToTheCoordinates) {
  const auto doubled = [](Json& material) {
    material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {
        {"KHR_texture_transform", {{"scale", {2, 2}}}}};
  };
  write("plain.glb", textured([](Json&) {}));
  write("halved.glb", textured(doubled, {0, 0, 0.5F, 0, 0.5F, 0.5F, 0, 0.5F}));
  write("doubled.glb", textured(doubled));
  for (const char* how : {"auto", "nearest"}) {
    const auto same = diff({"plain.glb", "halved.glb", "--materials", "--match", how});
    EXPECT_EQ(same.exit_code, 0) << same.out;
    EXPECT_EQ(diff({"plain.glb", "doubled.glb", "--match", how}).exit_code, 1);
    EXPECT_EQ(largest({"plain.glb", "doubled.glb", "--match", how}, "texture coordinates"), 1);
  }
}

// Two squares, by two nodes or by one with two instances.
TEST_F(KrokDiffAsPlayed, InstancesAreMeshesOfTheirOwn) {
  GlbBuilder nodes = square();
  nodes.json["nodes"] = {{{"name", "Body"}, {"mesh", 0}, {"translation", {0, 0, 0}}},
                         {{"name", "Body"}, {"mesh", 0}, {"translation", {0, 3, 0}}}};
  nodes.json["scenes"][0]["nodes"] = {0, 1};
  const auto instanced = [](float height) {
    GlbBuilder builder = square();
    const int places = builder.add(std::vector<float>{0, 0, 0, 0, height, 0}, "VEC3");
    builder.json["nodes"][0]["extensions"] = {
        {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}};
    builder.json["extensionsUsed"] = nlohmann::json::array({"EXT_mesh_gpu_instancing"});
    builder.json["extensionsRequired"] = nlohmann::json::array({"EXT_mesh_gpu_instancing"});
    return builder;
  };
  write("nodes.glb", nodes);
  write("instances.glb", instanced(3));
  write("moved.glb", instanced(3.5F));
  const auto same = diff({"nodes.glb", "instances.glb"});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
  EXPECT_EQ(same.err, "");
  EXPECT_THAT(same.out, HasSubstr("2 meshes, 8 vertices"));
  EXPECT_NEAR(largest({"instances.glb", "moved.glb"}, "positions"), 0.5, 1e-6);
  EXPECT_EQ(diff({"nodes.glb", "moved.glb"}).exit_code, 1);
}

TEST_F(KrokDiffAsPlayed, HiddenNodesDiffer) {
  GlbBuilder hidden = square();
  hidden.json["nodes"] = {{{"name", "Top"},
                           {"children", {1}},
                           {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}},
                          {{"name", "Body"}, {"mesh", 0}}};
  write("shown.glb", square());
  write("hidden.glb", hidden);
  for (const char* how : {"auto", "nearest"}) {
    const auto found = diff({"shown.glb", "hidden.glb", "--match", how});
    EXPECT_EQ(found.exit_code, 1) << found.out;
    EXPECT_THAT(found.out, HasSubstr("mesh Body: hidden in the second")) << how;
    EXPECT_EQ(diff({"hidden.glb", "hidden.glb", "--match", how}).exit_code, 0);
  }
}

// What is not compared is said, with how much there is of it, and in the report.
TEST_F(KrokDiffAsPlayed, WhatIsNotComparedIsSaid) {
  GlbBuilder lit = square();
  lit.json["extensionsUsed"] = {"VENDOR_light", "VENDOR_physics"};
  primitive_of(lit)["attributes"]["_WIND"] = primitive_of(lit)["attributes"]["POSITION"];
  write("plain.glb", square());
  write("lit.glb", lit);
  const auto found = diff({"plain.glb", "lit.glb"});
  EXPECT_EQ(found.exit_code, 0) << found.out;
  EXPECT_THAT(found.err,
              HasSubstr("lit.glb: not compared: 1 vertex attribute of other names, extension "
                        "VENDOR_light, extension VENDOR_physics"));
  EXPECT_THAT(report_of({"plain.glb", "lit.glb"}).dump(),
              HasSubstr("not compared: 1 vertex attribute"));
  EXPECT_THAT(diff({"plain.glb", "plain.glb"}).err, Not(HasSubstr("not compared")));
}

// An option that has no effect is said to have none.
TEST_F(KrokDiffAsPlayed, OptionsWithoutEffectAreReported) {
  write("a.glb", square());
  std::string points("POINTCACHE2\0", 12);
  const auto add = [&points](auto value) {
    points.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  add(std::int32_t{1});
  add(std::int32_t{4});
  add(0.0F);
  add(1.0F);
  add(std::int32_t{1});
  for (const float value : square_positions()) add(value);
  put("a.pc2", points);
  const auto done = diff({"a.glb", "a.pc2", "--materials"});
  EXPECT_EQ(done.exit_code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, HasSubstr("note: --materials has no effect"));
  EXPECT_THAT(diff({"a.glb", "a.glb", "--materials"}).out, Not(HasSubstr("no effect")));
}

}  // namespace
}  // namespace krok::test
