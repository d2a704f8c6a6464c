// krok-skin on a .character. Would fail if materials, pictures, eyes or expressions got lost on the
// way into glTF, if an expression at rest did not show, or if a character could name files outside
// of its folder.

#include <nlohmann/json.hpp>

#include "cli/hero_character.h"

namespace krok::test {
namespace {

class SkinCharacter : public HeroCharacter {
 protected:
  json gltf(const std::string& name) { return json::parse(get(path(name))); }
};

TEST_F(SkinCharacter, ARigHasItsMaterialsEyesAndExpressions) {
  tool("krok-skin", {"hero.character", "in.anim", "--as", "rig", "-o", "hero.gltf"});
  const json made = gltf("hero.gltf");
  ASSERT_EQ(made["materials"].size(), 1u);
  EXPECT_EQ(made["materials"][0]["name"], "Skin");
  EXPECT_EQ(made["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"], 0.25);
  EXPECT_EQ(made["images"].size(), 1u);
  EXPECT_EQ(made["meshes"][0]["extras"]["targetNames"], json::array({"bow"}));
  // The eye hangs on the head, where it is in the reference pose: 1.8 m up in all.
  bool found = false;
  for (const json& node : made["nodes"]) {
    for (const json& child : node.value("children", json::array())) {
      found = found || (node["name"] == "Head" &&
                        made["nodes"][child.get<std::size_t>()]["name"] == "left_eye");
    }
  }
  EXPECT_TRUE(found);
}

// Coordinates that a texture uses stay, others go, and nothing that is seen changes.
TEST_F(SkinCharacter, MinifyLeavesOutWhatNothingUses) {
  const auto has_coordinates = [this](const std::string& name) {
    return gltf(name)["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_0");
  };
  tool("krok-skin", {"in.model", "in.anim", "-o", "whole.gltf"});
  tool("krok-skin", {"in.model", "in.anim", "--minify", "-o", "small.gltf"});
  EXPECT_TRUE(has_coordinates("whole.gltf"));
  EXPECT_FALSE(has_coordinates("small.gltf"));
  EXPECT_FALSE(gltf("small.gltf")["asset"].contains("extras"));
  const std::string output = tool("krok-diff", {"whole.gltf", "small.gltf"}, 1).out;
  EXPECT_NE(output.find("positions: equal"), std::string::npos) << output;
  EXPECT_NE(output.find("texture coordinates"), std::string::npos) << output;
  tool("krok-skin", {"hero.character", "in.anim", "--minify", "-o", "hero.gltf"});
  EXPECT_TRUE(has_coordinates("hero.gltf"));
}

TEST_F(SkinCharacter, AnExpressionAtRestShows) {
  tool("krok-skin", {"hero.character", "--as", "pose", "-o", "pose.glb"});
  expect_same("pose.glb", "bent.glb");
}

TEST_F(SkinCharacter, WeightsChangeWhatTheyNameAndNothingElse) {
  put("bow.json",
      R"({"schema": "krok.weights/1", "curves": [{"target": "bow", "keys": [[0, 0]]}]})");
  put("none.json", R"({"schema": "krok.weights/1", "curves": []})");
  tool("krok-skin", {"hero.character", "--weights", "bow.json", "--as", "pose", "-o", "up.glb"});
  tool("krok-skin", {"in.model", "--as", "pose", "-o", "plain.glb"});
  expect_same("up.glb", "plain.glb");
  tool("krok-skin", {"hero.character", "--weights", "none.json", "--as", "pose", "-o", "rest.glb"});
  expect_same("rest.glb", "bent.glb");
}

// Eyes are placed in the model; who gives a place in the head's frame, or in centimetres, is told.
TEST_F(SkinCharacter, EyesFarFromTheirJointAreWarnedOf) {
  const auto warning = [&](const std::string& place) {
    std::string text = get(path("hero.character"));
    const std::size_t from = text.find('[', text.find("position"));
    text.replace(from, text.find(']', from) + 1 - from, place);
    put("hero.character", text);
    return tool("krok-info", {"hero.character"}).err;
  };
  EXPECT_EQ(warning("[0.03, 0.8, 0.1]"), "");
  EXPECT_THAT(warning("[3, 80, 10]"),
              AllOf(HasSubstr("m from its joint 'Head'"), HasSubstr("[character-eye]")));
}

TEST_F(SkinCharacter, AnObjWithoutAMotionIsAPose) {
  tool("krok-skin", {"in.model", "-o", "rest.obj"});
  EXPECT_THAT(get(path("rest.obj")), HasSubstr("\nv "));
}

TEST_F(SkinCharacter, FilesOutsideOfItsFolderAreRefused) {
  put_character("[]", "../in.model");
  const std::string told = tool("krok-skin", {"hero.character", "-o", "x.glb"}, 2).err;
  EXPECT_NE(told.find("hero.character:1:"), std::string::npos) << told;
  put_character("[]");
  tool("krok-skin", {"hero.character", "--morph", "bent.exr", "-o", "x.glb"}, 2);
  EXPECT_FALSE(std::filesystem::exists(path("x.glb")));
}

}  // namespace
}  // namespace krok::test
