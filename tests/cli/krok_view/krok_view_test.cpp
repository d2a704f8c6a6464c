// If these fail, krok-view leaves its user with a page that shows nothing, or without knowing why
// there is none. What the page does in a browser is tested in tests/page.

#include <gmock/gmock.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "cli/kept_files.h"
#include "shown_page.h"

namespace krok::test {
namespace {

const std::string kMotion = kFrozen + "motion.anim";

class KrokView : public CliTest {
 protected:
  ToolRun view(std::vector<std::string> arguments) const {
    arguments.push_back("-o");
    arguments.push_back(path("page.html"));
    return run_tool("krok-view", arguments);
  }
  json data() const { return data_of(get(path("page.html"))); }
};

TEST_F(KrokView, ShowsAMotionWithABodyMadeForIt) {
  const ToolRun run = view({kMotion});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("1 character"));
  EXPECT_THAT(listing(), ElementsAre("page.html"));
  const json shown = data();
  EXPECT_EQ(shown["schema"], "krok.view/1");
  EXPECT_EQ(shown["title"], "motion.anim");
  ASSERT_EQ(shown["items"].size(), 1U);
  EXPECT_EQ(shown["items"][0]["kind"], "motion");
  EXPECT_TRUE(shown["items"][0].contains("body"));
}

TEST_F(KrokView, TakesACaptureAsItIs) {
  ASSERT_EQ(view({kWalk, "--body", "none"}).exit_code, 0);
  const json item = data()["items"][0];
  EXPECT_EQ(item["frames"], 264);
  EXPECT_EQ(item["rate"], 60.0);
  EXPECT_FALSE(item.contains("body"));
}

TEST_F(KrokView, GivesAModelToTheMotionOfItsSkeleton) {
  ASSERT_EQ(run_tool("krok-body", {kMotion, "--detail", "low", "-o", path("own.model")}).exit_code,
            0);
  ASSERT_EQ(view({path("own.model"), kMotion}).exit_code, 0);
  const json items = data()["items"];
  ASSERT_EQ(items.size(), 1U);
  EXPECT_GT(items[0]["body"]["positions"]["count"].get<int>(), 3 * 2000);
  EXPECT_LT(items[0]["body"]["positions"]["count"].get<int>(), 3 * 3000);
}

TEST_F(KrokView, ShowsAModelAloneInItsReferencePose) {
  ASSERT_EQ(view({kFrozen + "full.model"}).exit_code, 0);
  const json items = data()["items"];
  ASSERT_EQ(items.size(), 1U);
  EXPECT_EQ(items[0]["frames"], 0);
}

TEST_F(KrokView, ShowsTheKeysThatStandBesideAMotion) {
  const std::string motion = put("walk.bvh", get(kWalk));
  ASSERT_EQ(view({motion, "--body", "none"}).exit_code, 0);
  EXPECT_FALSE(data()["items"][0].contains("keytimes"));
  put("walk.keys.json", R"({"schema": "krok.keys/1", "keytimes": [{"name": "hop", "time": 1.5}],
      "contacts": [{"joint": "LeftFoot", "start": 1, "end": 2, "place": [0, 0, 0]}]})");
  ASSERT_EQ(view({motion, "--body", "none"}).exit_code, 0);
  const json item = data()["items"][0];
  ASSERT_EQ(item["keytimes"].size(), 1U);
  EXPECT_EQ(item["keytimes"][0]["name"], "hop");
  ASSERT_EQ(item["contacts"].size(), 1U);
  EXPECT_EQ(item["contacts"][0]["end"], 2.0);
  ASSERT_EQ(view({motion, "--body", "none", "--contacts", "none"}).exit_code, 0);
  EXPECT_FALSE(data()["items"][0].contains("keytimes"));
  ASSERT_EQ(view({motion, "--body", "none", "--contacts", "find"}).exit_code, 0);
  EXPECT_EQ(data()["items"][0]["keytimes"].size(), 17U);
}

TEST_F(KrokView, SaysWhatIsWrongWithTheKeysBesideAMotion) {
  const std::string motion = put("walk.bvh", get(kWalk));
  put("walk.keys.json", R"({"schema": "krok.keys/1", "keytimes": [{"name": "hop", "time": 99}]})");
  const ToolRun run = view({motion, "--body", "none"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("walk.keys.json:1:"));
  EXPECT_TRUE(has_code(run.err, "keys-time")) << run.err;
}

TEST_F(KrokView, ShowsACamera) {
  ASSERT_EQ(view({kMotion, kFrozen + "camera.cam", "--body", "none"}).exit_code, 0);
  const json items = data()["items"];
  ASSERT_EQ(items.size(), 2U);
  EXPECT_EQ(items[1]["kind"], "camera");
}

TEST_F(KrokView, ListsManyFilesOneAtATime) {
  std::vector<std::string> files(6, kMotion);
  ASSERT_EQ(view(files).exit_code, 0);
  const json items = data()["items"];
  ASSERT_EQ(items.size(), 6U);
  EXPECT_EQ(items[0]["visible"], true);
  EXPECT_EQ(items[5]["visible"], false);
}

TEST_F(KrokView, GivesTheSameBytesAgain) {
  ASSERT_EQ(view({kMotion, "-j", "1"}).exit_code, 0);
  const std::string first = get(path("page.html"));
  ASSERT_EQ(view({kMotion, "-j", "2"}).exit_code, 0);
  EXPECT_EQ(get(path("page.html")), first);
}

TEST_F(KrokView, SaysWhatItCannotShow) {
  const std::string text = put("notes.txt", "no motion at all\n");
  const ToolRun run = view({text});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("notes.txt"));
  EXPECT_THAT(listing(), ElementsAre("notes.txt"));
}

TEST_F(KrokView, SaysThatADifferenceNeedsTwo) {
  const ToolRun run = view({kMotion, "--difference"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("--difference needs two motions"));
  EXPECT_THAT(listing(), IsEmpty());
}

// The page gets one GLB that holds what the .gltf names; what cannot be had is said.
TEST_F(KrokView, PacksAGltfWithItsFiles) {
  ASSERT_EQ(run_tool("krok-body", {kMotion, "-o", path("b.model"), "-q"}).exit_code, 0);
  ASSERT_EQ(
      run_tool("krok-skin", {path("b.model"), kMotion, "--as", "rig", "-o", path("rig.glb"), "-q"})
          .exit_code,
      0);
  // The same in two files, with an image that is not there.
  const std::string glb = get(path("rig.glb"));
  const auto u32 = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, glb.data() + at, 4);
    return value;
  };
  const std::uint32_t json_size = u32(12), bin_size = u32(20 + json_size);
  json scene = json::parse(glb.substr(20, json_size));
  scene["buffers"][0]["uri"] = "rig%20data.bin";
  scene["buffers"][0]["byteLength"] = bin_size;
  scene["images"] = json::array({{{"uri", "gone.png"}}});
  put("rig data.bin", glb.substr(28 + json_size, bin_size));
  put("rig.gltf", scene.dump());
  const ToolRun run = view({path("rig.gltf"), "--json=" + path("report.json")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has_code(run.err, "gltf-image")) << run.err;
  EXPECT_EQ(json::parse(get(path("report.json")))["inputs"].size(), 2U);
  const json item = data()["items"][0];
  EXPECT_EQ(item["kind"], "gltf");
  put("rig.gltf",
      json::parse(scene.dump()).dump().replace(scene.dump().find("rig%20data"), 3, "../"));
  EXPECT_EQ(view({path("rig.gltf")}).exit_code, 2);
}

// If this fails, a page of many takes of one actor is as many times as large as it has to be.
TEST_F(KrokView, TakesOfOneSkeletonShareABody) {
  for (const char* name : {"a.bvh", "b.bvh", "c.bvh", "d.bvh", "e.bvh", "f.bvh"}) {
    put(name, capture(4));
  }
  ASSERT_EQ(view({path("a.bvh"), path("b.bvh"), path("c.bvh"), path("d.bvh"), path("e.bvh"),
                  path("f.bvh")})
                .exit_code,
            0);
  const json items = data()["items"];
  ASSERT_EQ(items.size(), 6U);
  for (const json& item : items) EXPECT_EQ(item["body"]["blob"], "krok-body-0") << item["name"];
  EXPECT_EQ(element_of(get(path("page.html")), "krok-body-1"), "");
}

// If this fails, a clip of a glTF cannot be chosen, or is counted in frames that it has not.
TEST_F(KrokView, KnowsClipsOfGltfAndTheirRates) {
  const json two =
      json::parse(R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
      "nodes": [{"name": "Thing"}], "bufferViews": [{"buffer": 0, "byteLength": 12},
      {"buffer": 0, "byteOffset": 12, "byteLength": 36}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR",
      "min": [0], "max": [0.0666667]}, {"bufferView": 1, "componentType": 5126, "count": 3,
      "type": "VEC3"}], "buffers": [{"byteLength": 48, "uri": "data:application/octet-stream;base64,)"
                  R"(AAAAAImICD2JiIg9AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAQAAAAAAAAAAA"}],
      "animations": [{"name": "walk", "channels": [{"sampler": 0, "target": {"node": 0,
      "path": "translation"}}], "samplers": [{"input": 0, "output": 1}]}, {"name": "run",
      "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
      "samplers": [{"input": 0, "output": 1}]}]})");
  put("two.gltf", two.dump());
  ASSERT_EQ(view({path("two.gltf"), "--clip", "run"}).exit_code, 0);
  const json item = data()["items"][0];
  EXPECT_EQ(item["animation"], 1);
  EXPECT_EQ(item["rates"], json({30.0, 30.0}));
  const ToolRun none = view({path("two.gltf"), "--clip", "jump"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_TRUE(has_code(none.err, "view-clip")) << none.err;
  EXPECT_THAT(none.err, HasSubstr("walk, run"));
}

TEST_F(KrokView, AFolderIsAListOfWhatMovesInIt) {
  std::filesystem::create_directories(path("takes/more"));
  std::filesystem::create_directories(path("empty"));
  for (const char* name : {"takes/a.bvh", "takes/b.bvh", "takes/more/c.bvh"}) put(name, capture(4));
  put("takes/notes.txt", "none");
  ASSERT_EQ(view({path("takes"), "--body", "none"}).exit_code, 0);
  const json items = data()["items"];
  ASSERT_EQ(items.size(), 3U);
  EXPECT_EQ(items[0]["name"], "a.bvh");
  EXPECT_EQ(items[2]["name"], "c.bvh");
  put("takes/mark.cam", "x");
  const ToolRun again = run_tool("krok-view", {path("takes"), "--body", "none", "-v"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(has_code(again.err, "folder-left-out")) << again.err;
  EXPECT_TRUE(std::filesystem::exists(path("takes.html"))) << "beside the folder";
  put("empty/notes.txt", "none");
  const ToolRun empty = view({path("empty")});
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_TRUE(has_code(empty.err, "folder-empty")) << empty.err;
}

}  // namespace
}  // namespace krok::test
