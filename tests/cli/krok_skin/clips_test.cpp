// krok-skin with several motions, and the names in what it writes. Would fail if clips of a game
// engine's file could not be told apart by name, if one clip had another's keys, or if the meshes
// of a character became one.
#include "cli/hero_character.h"

namespace krok::test {
namespace {

class SkinClips : public HeroCharacter {
 protected:
  void SetUp() override {
    HeroCharacter::SetUp();
    put("run.bvh", capture(12, "0.3"));
    tool("krok-import", {"run.bvh", "-o", "run.anim"});
    std::filesystem::create_directory(path("more"));
    std::filesystem::copy(path("run.anim"), path("more/run.anim"));
  }

  json gltf(const std::string& name) const { return json::parse(get(path(name))); }

  static std::vector<std::string> names(const json& list) {
    std::vector<std::string> result;
    for (const json& one : list) result.push_back(one["name"]);
    return result;
  }
};

TEST_F(SkinClips, SeveralMotionsAreClipsOfOneRigNamedAfterTheirFiles) {
  const ToolRun run = tool("krok-skin", {"hero.character", "in.anim", "run.anim", "more/run.anim",
                                         "-o", "hero.gltf", "--json"});
  const json hero = gltf("hero.gltf");
  EXPECT_THAT(names(hero["animations"]), ElementsAre("in", "run", "run_2"));
  EXPECT_EQ(hero["skins"].size(), 1U);
  EXPECT_EQ(hero["meshes"].size(), 1U);
  const json clips = json::parse(run.out)["result"]["clips"];
  EXPECT_THAT(names(clips), ElementsAre("in", "run", "run_2"));
  EXPECT_EQ(clips[0]["frames"], 20);
  EXPECT_EQ(clips[1]["frames"], 12);
}

TEST_F(SkinClips, AFolderIsAllMotionsInIt) {
  std::filesystem::copy(path("in.anim"), path("more/in.anim"));
  ASSERT_EQ(tool("krok-skin", {"hero.character", "more", "-o", "folder.gltf"}).exit_code, 0);
  EXPECT_THAT(names(gltf("folder.gltf")["animations"]), ElementsAre("in", "run"));
  std::filesystem::create_directory(path("none"));
  const ToolRun none =
      run_tool("krok-skin", {path("hero.character"), path("none"), "-o", path("x.glb")});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("folder-empty"), std::string::npos) << none.err;
}

// By what the file says to a reader.
TEST_F(SkinClips, EachClipIsItsMotion) {
  tool("krok-skin", {"in.model", "in.anim", "run.anim", "-o", "two.glb"});
  for (const std::string clip : {"in", "run"}) {
    tool("krok-import", {"two.glb", "--clip", clip, "-o", "back.anim", "--fps", "30"});
    tool("krok-import", {clip + ".bvh", "-o", "there.anim", "--fps", "30"});
    tool("krok-diff", {"back.anim", "there.anim", "--tolerance", "0.02mm", "--angle", "0.05deg"});
  }
}

TEST_F(SkinClips, MotionsWithoutTheMeshHaveTheSameJoints) {
  tool("krok-skin",
       {"hero.character", "in.anim", "run.anim", "--as", "motion", "-o", "moves.gltf"});
  tool("krok-skin", {"hero.character", "in.anim", "-o", "hero.gltf"});
  const json moves = gltf("moves.gltf"), hero = gltf("hero.gltf");
  EXPECT_THAT(names(moves["animations"]), ElementsAre("in", "run"));
  EXPECT_FALSE(moves.contains("meshes"));
  ASSERT_EQ(moves["skins"][0]["joints"].size(), hero["skins"][0]["joints"].size());
  for (std::size_t j = 0; j < moves["skins"][0]["joints"].size(); ++j) {
    EXPECT_EQ(moves["nodes"][j]["name"], hero["nodes"][j]["name"]);
  }
}

// If this fails, a name that is given twice is changed without a word.
TEST_F(SkinClips, ANameGivenTwiceIsWarnedOf) {
  const ToolRun twice =
      tool("krok-skin", {"hero.character", "go=in.anim", "go=run.anim", "-o", "x.gltf"});
  EXPECT_TRUE(has_code(twice.err, "skin-name")) << twice.err;
  EXPECT_THAT(names(gltf("x.gltf")["animations"]), ElementsAre("go", "go_2"));
}

TEST_F(SkinClips, ARigIsTheDefaultAndAPointCacheIsBaked) {
  tool("krok-skin", {"in.model", "in.anim", "-o", "rig.gltf"});
  EXPECT_TRUE(gltf("rig.gltf").contains("skins"));
  tool("krok-skin", {"in.model", "in.anim", "-o", "cache.pc2"});
  tool("krok-skin", {"in.model", "-o", "still.gltf"});
  EXPECT_FALSE(gltf("still.gltf").contains("animations"));
  const ToolRun old = tool("krok-skin", {"in.model", "in.anim", "--as", "clip", "-o", "x.glb"}, 2);
  EXPECT_THAT(old.err, HasSubstr("baked")) << "which is what clip was called";
}

TEST_F(SkinClips, SeveralMotionsAreRefusedWhereOneIsMeant) {
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--as", "baked"},
                                               {"--as", "pose"},
                                               {"--to", "5f"},
                                               {"--weights", "none.json"}}) {
    std::vector<std::string> arguments = {"hero.character", "in.anim", "run.anim", "-o", "x.glb"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_TRUE(has_code(tool("krok-skin", arguments, 2).err, "usage"));
  }
  put("other.bvh", [] {
    std::string text = capture(5);
    text.replace(text.find("Spine"), 5, "Trunk");
    return text;
  }());
  tool("krok-import", {"other.bvh", "-o", "other.anim"});
  const ToolRun other =
      tool("krok-skin", {"hero.character", "in.anim", "other.anim", "-o", "x.glb"}, 2);
  EXPECT_THAT(other.err, AllOf(HasSubstr("other.anim"), HasSubstr("--retarget")));
  EXPECT_FALSE(std::filesystem::exists(path("x.glb")));
}

// As another program exports a character: a mesh each for the body and the hat.
TEST_F(SkinClips, MeshesKeepTheirNames) {
  tool("krok-skin", {"in.model", "in.anim", "-o", "two.gltf"});
  json two = gltf("two.gltf");
  two["meshes"][0]["name"] = "Knight";
  two["meshes"].push_back(two["meshes"][0]);
  two["meshes"][1]["name"] = "Hat";
  json node;
  for (const json& each : two["nodes"]) {
    if (each.contains("mesh")) node = each;
  }
  node["mesh"] = 1;
  node["name"] = "hat node";
  two["nodes"].push_back(node);
  two["scenes"][0]["nodes"].push_back(two["nodes"].size() - 1);
  put("two.gltf", two.dump());
  tool("krok-import", {"two.gltf", "--save-model", "two.model", "-o", "two.anim"});
  for (const std::string as : {"rig", "baked"}) {
    tool("krok-skin", {"two.model", "two.anim", "--as", as, "-o", "again.gltf"});
    EXPECT_THAT(names(gltf("again.gltf")["meshes"]), ElementsAre("Knight", "Hat")) << as;
  }
  tool("krok-skin", {"two.model", "two.anim", "-o", "again.gltf"});
  tool("krok-import", {"again.gltf", "--save-model", "again.model"});
  tool("krok-diff", {"two.model", "again.model", "--tolerance", "0.01mm"});
}

// Would fail if a sheet left out animations, or a rendered image did so without a word.
TEST_F(SkinClips, ImagesShowAllClipsOrTheNamedOne) {
  tool("krok-skin", {"hero.character", "in.anim", "run.anim", "-o", "hero.glb"});
  const ToolRun all = tool("krok-plot", {"hero.glb", "--sheet", "a.png", "--view", "front",
                                         "--moments", "0s,0.3s", "--json"});
  const json report = json::parse(all.out);
  std::vector<std::string> rows;
  for (const json& cell : report["result"]["sheet"]["cells"]) {
    if (cell["column"] == 0) rows.push_back(cell["name"]);
  }
  EXPECT_THAT(rows, ElementsAre("hero.glb: in", "hero.glb: run"));
  const ToolRun first = tool("krok-render", {"hero.glb", "-o", "f.png"});
  EXPECT_THAT(first.err, AllOf(HasSubstr("0 (in), 1 (run)"), HasSubstr("[clip-choice]")));
  const ToolRun run = tool("krok-plot", {"hero.glb", "--clip", "run", "--sheet", "b.png",
                                         "--moments", "0s,0.3s", "--json"});
  EXPECT_EQ(json::parse(run.out)["issues"].size(), 0U);
  const ToolRun none = tool("krok-plot", {"hero.glb", "--clip", "walk", "--sheet", "c.png"}, 2);
  EXPECT_TRUE(has_code(none.err, "clip-name")) << none.err;
}

// Would fail if a tool took one animation of a file for the whole of it where it makes one result
// of many motions or a file of each, or if FILE#ANIMATION were another one, or of another file.
TEST_F(SkinClips, EachAnimationOfAFileIsAMotion) {
  tool("krok-skin", {"in.model", "in.anim", "run.anim", "-o", "hero.glb"});
  tool("krok-skin", {"in.model", "hero.glb", "-o", "again.gltf"});
  EXPECT_THAT(names(gltf("again.gltf")["animations"]), ElementsAre("in", "run"));
  expect_same("hero.glb", "again.gltf");
  tool("krok-edit", {"run.anim", "--turn", "10deg", "-o", "run_turned.anim"});
  tool("krok-edit", {"hero.glb#run", "--turn", "10deg", "-o", "one.anim"});
  expect_same("one.anim", "run_turned.anim");
  EXPECT_THAT(tool("krok-info", {"one.anim"}).out, HasSubstr("hero.glb#run (xxh3"));
  tool("krok-edit", {"hero.glb#1", "--turn", "10deg", "-o", "second.anim"});
  const ToolRun batch = tool("krok-edit", {"hero.glb", "--turn", "10deg", "--out-dir", "each"});
  EXPECT_FALSE(has_code(batch.err, "clip-choice")) << batch.err;
  tool("krok-diff", {"each/hero_run.anim", "second.anim"});
  const ToolRun again = tool("krok-edit", {"hero.glb", "--turn", "10deg", "--out-dir", "each"});
  EXPECT_THAT(again.err, HasSubstr("2 files, 2 unchanged"));
  for (const char* name : {"a", "b", "c", "d"}) {
    std::filesystem::copy(path("hero.glb"), path("more/" + std::string(name) + ".glb"));
  }
  const ToolRun table = tool("krok-info", {"more"});
  EXPECT_THAT(table.out,
              AllOf(HasSubstr("  2 animations  "), HasSubstr("\n8 animations in scenes")));
  // Would fail if a pipe were read to look for animations, and then again.
  ToolOptions piped;
  piped.folder = folder_.string();
  piped.input = get(path("in.anim"));
  EXPECT_EQ(
      run_tool("krok-skin", {"in.model", "-", "run.anim", "-o", "piped.glb"}, piped).exit_code, 0);
  const ToolRun none = tool("krok-edit", {"hero.glb#walk", "--turn", "1deg", "-o", "x.anim"}, 2);
  EXPECT_THAT(none.err, AllOf(HasSubstr("there is no animation walk"), HasSubstr("1 (run)")));
  // A body is of the skeleton, a camera follows the animation, an FBX is shown with all of them.
  tool("krok-body", {"hero.glb#run", "--detail", "low", "-o", "body.model"});
  tool("krok-cam", {"hero.glb#run", "--still", "-o", "still.cam"});
  tool("krok-cam", {"run.anim", "--still", "-o", "still_of_run.cam"});
  tool("krok-diff", {"still.cam", "still_of_run.cam"});
  // A file of the whole name comes first.
  std::filesystem::copy(path("run.anim"), path("hero.glb#in"));
  tool("krok-diff", {"hero.glb#in", "run.anim"});
}

}  // namespace
}  // namespace krok::test
