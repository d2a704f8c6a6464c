// If these fail, a character whose files do not fit together is taken for a good one, is refused
// without saying why, or makes a tool open what lies outside of its folder.

#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "formats/model/model_format.h"
#include "formats/morph_exr/morph_exr.h"
#include "golden/samples/samples.h"
#include "support/small_images.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class LookInfoTest : public CliTest {
 protected:
  // The model of the samples, whose parts are "body" of material "skin" and one of none; a face
  // with one target; a material.
  LookInfoTest() {
    put("a.model", text_of(samples::bytes_of(samples::model())));
    put("face.exr", text_of(face(samples::model().vertex_count())));
    put("skin.png", text_of(png()));
    put("a.material", R"({"schema": "krok.material/1", "materials": [
      {"name": "skin", "base_color_texture": "skin.png", "shaders": ["a.frag"]},
      {"name": "glass", "alpha": "blend", "double_sided": true}]})");
  }

  static std::vector<std::byte> face(int vertices) {
    MorphSet morphs;
    morphs.names = {"Smile"};
    morphs.vertex_count = vertices;
    morphs.positions.assign(static_cast<std::size_t>(vertices), Vec3f(0, 1, 0));
    return samples::bytes_of([&](OutputFile& file) { return morph_exr::write(morphs, file); });
  }

  ToolRun info(const std::string& members, const std::vector<std::string>& options = {}) {
    put("a.character",
        "{\"schema\": \"krok.character/1\", \"model\": \"a.model\", " + members + "}");
    std::vector<std::string> arguments = options;
    arguments.push_back(path("a.character"));
    return run_tool("krok-info", arguments);
  }
  void expect_fault(const std::string& members, const std::string& code, const std::string& says) {
    const ToolRun run = info(members);
    EXPECT_EQ(run.exit_code, 2) << members;
    EXPECT_TRUE(has_code(run.err, code)) << run.err;
    EXPECT_NE(run.err.find(says), std::string::npos) << run.err;
  }

  const std::string joint_ = samples::model().skeleton.names[1];
};

TEST_F(LookInfoTest, TellsMorphTargets) {
  const ToolRun run = run_here("krok-info", {"face.exr"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("morph targets (.exr)"), HasSubstr("Smile")));
}

TEST_F(LookInfoTest, TellsWhatACharacterIs) {
  const std::string members =
      "\"name\": \"Hero\", \"materials\": [\"a.material\"], \"morphs\": \"face.exr\", "
      "\"expressions\": [{\"name\": \"smile\", \"target\": \"Smile\", \"weight\": 0.25}], "
      "\"eyes\": [{\"name\": \"left\", \"joint\": \"" +
      joint_ + "\", \"position\": [1, 2, 3]}]";
  const ToolRun run = info(members);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* text :
       {"Hero", "a.model: 4 vertices, 2 triangles", "body, 1 triangle, material skin",
        "left at 1, 2, 3 m", "smile (0.25)", "base colour: skin.png (2 x 2)", "shaders a.frag",
        "joints       3, 1 of them end sites", "0.75 x 0.75 x 0.375 m (X, Y, Z; mesh in"}) {
    EXPECT_NE(run.out.find(text), std::string::npos) << text << "\n" << run.out;
  }
  // No part has it.
  EXPECT_EQ(run.out.find("glass"), std::string::npos) << run.out;
  const auto json = nlohmann::json::parse(info(members, {"--json"}).out);
  const auto& file = json["result"]["files"][0];
  EXPECT_EQ(file["kind"], "character");
  EXPECT_EQ(file["expressions"], nlohmann::json::parse(R"([{"name": "smile", "weight": 0.25}])"));
  EXPECT_EQ(file["eyes"][0]["position"], nlohmann::json({1, 2, 3}));
  EXPECT_EQ(file["materials"][0]["textures"][0]["file"], "skin.png");
  EXPECT_EQ(file["vertices"], 4);
  EXPECT_EQ(file["skeleton"][1]["joint"], joint_);
  EXPECT_EQ(json["inputs"].size(), 5u);  // all that it names, so that a batch notices changes
}

TEST_F(LookInfoTest, PartsGetTheMaterialsThatTheCharacterGivesThem) {
  const ToolRun run = info(
      "\"materials\": [\"a.material\"], \"parts\": [{\"name\": \"body\", \"material\": "
      "\"glass\"}]");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("body, 1 triangle, material glass"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("transparent, double-sided"), std::string::npos) << run.out;
}

// What joints are is found by their names, told by the character, or by whoever asks.
TEST_F(LookInfoTest, JointsHaveTheRolesThatTheCharacterGivesThem) {
  const auto roles = [&](const std::string& members, const std::vector<std::string>& options) {
    std::vector<std::string> json = {"--json"};
    json.insert(json.end(), options.begin(), options.end());
    return nlohmann::json::parse(info(members, json).out)["result"]["files"][0]["roles"];
  };
  put("own.json", R"({"joints": {")" + joint_ + R"(": "head"}})");
  put("other.json", R"({"joints": {")" + joint_ + R"(": "left_foot"}})");
  EXPECT_FALSE(roles(R"("name": "a")", {}).contains("head"));
  EXPECT_EQ(roles(R"("role_map": "own.json")", {})["head"], joint_);
  const auto given = roles(R"("role_map": "own.json")", {"--map", path("other.json")});
  EXPECT_FALSE(given.contains("head"));
  EXPECT_EQ(given["left_foot"], joint_);
}

// The face at rest makes it taller: the one target moves all vertices to 1 m.
TEST_F(LookInfoTest, TheSizeIsThatOfTheFaceAtRest) {
  const auto height = [&](const char* weight) {
    const std::string members = std::string(R"("morphs": "face.exr", "expressions": [
        {"name": "Smile", "weight": )") +
                                weight + "}]";
    const auto json = nlohmann::json::parse(info(members, {"--json"}).out);
    return json["result"]["files"][0]["height"].get<double>();
  };
  EXPECT_EQ(height("0"), 1.0);
  EXPECT_EQ(height("0.5"), 0.5);  // from 0.5 to 1
  EXPECT_EQ(height("1"), 0.0);
}

TEST_F(LookInfoTest, WhatDoesNotFitTogetherIsAnError) {
  expect_fault(R"("parts": [{"name": "bdy", "material": ""}])", "character-part",
               "did you mean 'body'?");
  expect_fault(R"("materials": ["a.material"], "parts": [{"name": "body", "material": "skn"}])",
               "character-material", "did you mean 'skin'?");
  expect_fault(R"("eyes": [{"name": "left", "joint": "Nobody", "position": [0, 0, 0]}])",
               "character-joint", "Nobody");
  expect_fault(R"("morphs": "face.exr", "expressions": [{"name": "Smil"}])", "character-target",
               "did you mean 'Smile'?");
  expect_fault(R"("materials": ["a.material", "a.material"])", "character-material", "two of its");
  put("other.exr", text_of(face(7)));
  expect_fault(R"("morphs": "other.exr")", "character-morphs", "7 vertices");
  expect_fault(R"("materials": ["none.material"])", "file-missing", "none.material");
  expect_fault(R"("role_map": "none.json")", "file-missing", "none.json");
  put("skin.png", "no picture");
  expect_fault(R"("materials": ["a.material"])", "picture-kind", "skin.png");
  put("a.material", R"({"schema": "krok.material/1",
 "materials": [{"nam": "skin"}]})");
  expect_fault(R"("materials": ["a.material"])", "material-structure", "a.material:2:17");
}

TEST_F(LookInfoTest, AMaterialThatNoFileHasIsWarnedOf) {
  put("a.material", R"({"schema": "krok.material/1", "materials": [{"name": "other"}]})");
  const ToolRun run = info(R"("materials": ["a.material"])");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(has_code(run.err, "character-material")) << run.err;
  EXPECT_EQ(info("\"materials\": []").err, "");
}

TEST_F(LookInfoTest, LinksOutOfTheFolderAreRefused) {
  fs::create_directory(path("in"));
  const auto link = [&](const std::string& name) {
    fs::create_symlink("../" + name, path("in/" + name));
  };
  for (const char* name : {"a.model", "face.exr", "a.material"}) link(name);
  fs::create_directory(path("in/sub"));
  put("in/b.character", R"({"schema": "krok.character/1", "model": "a.model"})");
  const ToolRun run = run_tool("krok-info", {path("in/b.character")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "path-outside")) << run.err;
  fs::remove(path("in/a.model"));
  fs::copy_file(path("a.model"), path("in/a.model"));
  EXPECT_EQ(run_tool("krok-info", {path("in/b.character")}).exit_code, 0);
  for (const char* member : {R"("materials": ["a.material"])", R"("morphs": "face.exr")"}) {
    put("in/b.character",
        std::string(R"({"schema": "krok.character/1", "model": "a.model", )") + member + "}");
    const ToolRun linked = run_tool("krok-info", {path("in/b.character")});
    EXPECT_EQ(linked.exit_code, 2) << member;
    EXPECT_TRUE(has_code(linked.err, "path-outside")) << linked.err;
  }
}

TEST_F(LookInfoTest, MaterialsTellOfImagesThatCannotBeUsed) {
  const ToolRun good = run_tool("krok-info", {path("a.material")});
  EXPECT_EQ(good.exit_code, 0);
  EXPECT_NE(good.out.find("base colour: skin.png (2 x 2 PNG)"), std::string::npos) << good.out;
  fs::remove(path("skin.png"));
  const ToolRun lost = run_tool("krok-info", {path("a.material")});
  EXPECT_EQ(lost.exit_code, 0);
  EXPECT_TRUE(has_code(lost.err, "file-missing")) << lost.err;
  EXPECT_NE(lost.out.find("glass"), std::string::npos) << lost.out;
}

}  // namespace
}  // namespace krok::test
