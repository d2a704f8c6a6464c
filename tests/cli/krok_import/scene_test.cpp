// If these fail, krok-import of a character's file writes something else than asked for, hides what
// the file lacks, or leaves half of its outputs behind.

#include <nlohmann/json.hpp>

#include "formats/cam/cam.h"
#include "formats/model/model_format.h"
#include "imported.h"
#include "support/glb_builder.h"
#include "support/this_build.h"
#include "unit/assimp/sample_md5.h"

namespace krok::test {
namespace {

using Json = nlohmann::ordered_json;

class SceneImportTest : public CliTest {
 protected:
  std::string put_glb(const std::string& name, const GlbBuilder& builder) const {
    const auto bytes = builder.glb();
    return put(name, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }

  // The rig with a second animation, a camera that the second joint carries, and a morph target.
  static GlbBuilder character() {
    GlbBuilder builder = rig();
    auto& document = builder.json;
    Json second = document["animations"][0];
    second["name"] = "Bend/twice";
    document["animations"].push_back(second);
    document["cameras"] = {{{"name", "Lens"},
                            {"type", "perspective"},
                            {"perspective", {{"yfov", 0.7}, {"znear", 1}}}}};
    document["nodes"].push_back({{"name", "Shot"}, {"camera", 0}, {"translation", {0, 0, 2}}});
    document["nodes"][2]["children"] = nlohmann::json::array({3});
    auto& primitive = document["meshes"][0]["primitives"][0];
    primitive["targets"] = {
        {{"POSITION",
          builder.add(std::vector<float>{0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3")}}};
    document["meshes"][0]["extras"] = {{"targetNames", {"Nose"}}};
    document["meshes"][0]["weights"] = nlohmann::json::array({0.5});
    return builder;
  }

  // Two boxes and a floor; the boxes rise, in `clips` animations together or one each.
  static GlbBuilder boxes(bool one_each) {
    GlbBuilder builder;
    const int times = builder.add(std::vector<float>{0, 1}, "SCALAR");
    builder.json["accessors"][times]["min"] = nlohmann::json::array({0});
    builder.json["accessors"][times]["max"] = nlohmann::json::array({1});
    const int moves = builder.add(std::vector<float>{0, 0, 0, 0, 1, 0}, "VEC3");
    const int corners = builder.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    builder.json["accessors"][corners]["min"] = {0, 0, 0};
    builder.json["accessors"][corners]["max"] = {1, 1, 0};
    const Json primitive = {{"attributes", {{"POSITION", corners}}}};
    builder.json["meshes"] = {{{"name", "Box"}, {"primitives", {primitive}}},
                              {{"name", "Floor"}, {"primitives", {primitive}}}};
    builder.json["nodes"] = {{{"name", "A"}, {"mesh", 0}},
                             {{"name", "B"}, {"mesh", 0}, {"translation", {2, 0, 0}}},
                             {{"name", "Ground"}, {"mesh", 1}, {"translation", {0, -1, 0}}}};
    builder.json["scenes"] = {{{"nodes", {0, 1, 2}}}};
    builder.json["scene"] = 0;
    std::vector<Json> channels;
    for (int node : {0, 1}) {
      channels.push_back({{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}});
    }
    const Json samplers = {{{"input", times}, {"output", moves}}};
    if (one_each) {
      builder.json["animations"] = {
          {{"name", "RiseA"}, {"samplers", samplers}, {"channels", {channels[0]}}},
          {{"name", "RiseB"}, {"samplers", samplers}, {"channels", {channels[1]}}}};
    } else {
      builder.json["animations"] = {
          {{"name", "Rise"}, {"samplers", samplers}, {"channels", channels}}};
    }
    return builder;
  }

  // The rig with a mesh of 6,000 vertices at some nodes.
  static GlbBuilder leaves(int count) {
    GlbBuilder builder = rig();
    auto& document = builder.json;
    std::vector<float> grid;
    for (int i = 0; i < 3 * 6000; ++i) grid.push_back(0.01f * static_cast<float>(i % 71));
    document["meshes"].push_back(
        {{"primitives", {{{"attributes", {{"POSITION", builder.add(grid, "VEC3")}}}}}}});
    for (int i = 0; i < count; ++i) {
      document["nodes"][1]["children"].push_back(document["nodes"].size());
      document["nodes"].push_back({{"name", "Leaf" + std::to_string(i)}, {"mesh", 1}});
    }
    return builder;
  }

  ToolRun import(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), path("in.glb"));
    return run_tool("krok-import", arguments);
  }
};

// If this fails, tools that read a file's motion lose its steps without a word.
TEST_F(SceneImportTest, StepsThatBecomeRampsAreWarnedOf) {
  for (const bool steps : {false, true}) {
    GlbBuilder builder = rig();
    builder.json["animations"][0]["channels"][0]["target"]["node"] = 1;  // which carries the tip
    if (steps) {
      for (Json& sampler : builder.json["animations"][0]["samplers"]) {
        sampler["interpolation"] = "STEP";
      }
    }
    put_glb("in.glb", builder);
    const ToolRun run = run_tool("krok-export", {path("in.glb"), "-o", path("a.csv")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(has_code(run.err, "scene-sampling"), steps) << run.err;
  }
}

// Viewers hold the first key until its time; the motion came back half a second early.
TEST_F(SceneImportTest, AFirstKeyThatIsNotAtZeroStaysWhereItIs) {
  GlbBuilder builder = rig();
  const int late = builder.add(std::vector<float>{0.5f, 1, 1.5f}, "SCALAR");
  builder.json["accessors"][late]["min"] = nlohmann::json::array({0.5});
  builder.json["accessors"][late]["max"] = nlohmann::json::array({1.5});
  for (Json& sampler : builder.json["animations"][0]["samplers"]) sampler["input"] = late;
  put_glb("in.glb", builder);
  const ToolRun run = import({"-o", path("a.anim"), "--save-character", path("a.character")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ASSERT_EQ(
      run_tool("krok-skin", {path("a.character"), path("a.anim"), "-o", path("b.glb")}).exit_code,
      0);
  const ToolRun diff = run_tool("krok-diff", {path("in.glb"), path("b.glb"), "--match", "order"});
  EXPECT_EQ(diff.exit_code, 0) << diff.out << diff.err;
}

// 1,900 places of one mesh became a file of 282 MB.
TEST_F(SceneImportTest, AMeshAtManyNodesIsRefusedOverAStatedGrowth) {
  put_glb("in.glb", leaves(200));
  const ToolRun run = import({"--save-character", path("a.character")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("[scene-instances]"), std::string::npos) << run.err;
  EXPECT_EQ(import({"-o", path("a.anim")}).exit_code, 0);
}

// Would fail if a character of three times the file's vertices came without a word.
TEST_F(SceneImportTest, CopiesOfAMeshAreSaid) {
  put_glb("in.glb", leaves(3));
  const ToolRun run = import({"--save-character", path("a.character")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("18,004 vertices, 3 times the file's"), std::string::npos) << run.err;
}

// A floor beside the actor was left out.
TEST_F(SceneImportTest, AStillMeshBesideOneThatMovesIsKept) {
  put_glb("in.glb", boxes(false));
  const ToolRun run = import({"-o", path("a.anim"), "--save-character", path("a.character")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err.find("scene-mesh"), std::string::npos) << run.err;
  ASSERT_EQ(
      run_tool("krok-skin", {path("a.character"), path("a.anim"), "-o", path("b.glb")}).exit_code,
      0);
  const ToolRun diff = run_tool("krok-diff", {path("in.glb"), path("b.glb"), "--match", "order"});
  EXPECT_NE(diff.out.find("3 meshes"), std::string::npos) << diff.out;
  EXPECT_EQ(diff.exit_code, 0) << diff.out;
}

// Would fail if a clip lacked the objects that only other clips move, as Blender writes them.
TEST_F(SceneImportTest, AClipForEachObjectIsTaken) {
  const std::string file = put_glb("in.glb", boxes(true));
  const ToolRun run = run_tool("krok-skin", {file, file, "-o", path("b.glb")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const ToolRun diff = run_tool("krok-diff", {file, path("b.glb"), "--match", "order"});
  EXPECT_EQ(diff.exit_code, 0) << diff.out;
}

TEST_F(SceneImportTest, MotionAndModelOfAGlb) {
  put_glb("in.glb", rig());
  const ToolRun run = import({"-o", path("a.anim"), "--save-model", path("a.model")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto motion = InputFile::open(path("a.anim"));
  const auto clip = anim::read(motion->bytes());
  ASSERT_TRUE(clip.ok());
  EXPECT_EQ(clip->skeleton.names, (std::vector<std::string>{"Root", "Tip"}));
  EXPECT_EQ(clip->rate, 30);  // keys at 0, 0.5 and 1 s
  EXPECT_EQ(clip->frame_count(), 31);
  const auto file = InputFile::open(path("a.model"));
  const auto model = model::read(file->bytes());
  ASSERT_TRUE(model.ok());
  EXPECT_EQ(model->vertex_count(), 4);
  EXPECT_EQ(model->triangles.size(), 2u);
  EXPECT_EQ(model->skeleton.names, clip->skeleton.names);
  EXPECT_EQ(model->provenance.sources.at(0).name, "in.glb");
}

// A T-pose of a character that is bound in an A-pose, say: the model does not have it.
TEST_F(SceneImportTest, ThePoseOfAFileWithoutAnimationsIsToldAndCanBeKept) {
  GlbBuilder builder = rig();
  builder.json.erase("animations");
  builder.json["nodes"][2]["rotation"] = {0.5, 0, 0, std::sqrt(0.75)};
  put_glb("in.glb", builder);
  const ToolRun model = import({"--save-model", path("a.model")});
  ASSERT_EQ(model.exit_code, 0) << model.err;
  EXPECT_NE(model.err.find("warning: without animation"), std::string::npos) << model.err;
  EXPECT_NE(model.err.find("-o POSE.anim"), std::string::npos) << model.err;
  const ToolRun pose = import({"--save-model", path("a.model"), "-o", path("pose.anim")});
  ASSERT_EQ(pose.exit_code, 0) << pose.err;
  EXPECT_EQ(pose.err.find("warning"), std::string::npos) << pose.err;
  const ToolRun skin = run_tool("krok-skin", {path("a.model"), path("pose.anim"), "--as", "pose",
                                              "--time", "0f", "-o", path("back.glb")});
  ASSERT_EQ(skin.exit_code, 0) << skin.err;
  const ToolRun same = run_tool("krok-diff", {path("in.glb"), path("back.glb")});
  EXPECT_NE(same.out.find("within in all"), std::string::npos) << same.out;
}

TEST_F(SceneImportTest, OneOutputAloneWillDo) {
  put_glb("in.glb", character());
  for (const auto& [option, name] :
       std::vector<std::pair<std::string, std::string>>{{"--save-model", "a.model"},
                                                        {"--save-cam", "a.cam"},
                                                        {"--save-morphs", "a.exr"},
                                                        {"--morph-weights", "a.csv"}}) {
    const ToolRun run = import({option, path(name)});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(listing(), (std::vector<std::string>{name, "in.glb"}));
    std::filesystem::remove(path(name));
  }
  const ToolRun nothing = import({});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_TRUE(has_code(nothing.err, "usage")) << nothing.err;
}

TEST_F(SceneImportTest, ACameraIsAsLongAsItsAnimation) {
  put_glb("in.glb", character());
  ASSERT_EQ(import({"--save-cam", path("a.cam"), "--rate", "10"}).exit_code, 0);
  const auto file = InputFile::open(path("a.cam"));
  const auto camera = cam::read(file->bytes());
  ASSERT_TRUE(camera.ok());
  EXPECT_EQ(camera->frame_count(), 11);
  EXPECT_FLOAT_EQ(camera->fields_of_view[0], 0.7f);
  EXPECT_LT((camera->positions[0] - Vec3f(0, 1, 2)).norm(), 1e-6f);
}

// As programs write that make an animation of each object: the camera's goes before the joints'.
class AnimationsOfObjectsTest : public SceneImportTest {
 protected:
  void SetUp() override {
    GlbBuilder builder = character();
    auto& document = builder.json;
    document["nodes"][2].erase("children");
    document["scenes"][0]["nodes"].push_back(3);
    const int times = builder.add(std::vector<float>{0, 3}, "SCALAR");
    const int places = builder.add(std::vector<float>{0, 0, 2, 3, 0, 2}, "VEC3");
    document["animations"][1] = {
        {"name", "Dolly"},
        {"samplers", {{{"input", times}, {"output", places}}}},
        {"channels", {{{"sampler", 0}, {"target", {{"node", 3}, {"path", "translation"}}}}}}};
    std::swap(document["animations"][0], document["animations"][1]);
    put_glb("in.glb", builder);
  }
  CameraTrack camera() const {
    const auto file = InputFile::open(path("a.cam"));
    auto track = cam::read(file->bytes());
    EXPECT_TRUE(track.ok());
    return *std::move(track);
  }
};

TEST_F(AnimationsOfObjectsTest, ThatOfTheSkeletonIsTakenWithTheReason) {
  const ToolRun run = import({"-o", path("a.anim"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has_code(run.err, "import-clips")) << run.err;
  EXPECT_FALSE(has_code(run.err, "import-still")) << run.err;
  const Json clip = Json::parse(run.out)["result"]["clip"];
  EXPECT_EQ(clip["name"], "Bend");
  EXPECT_EQ(clip["reason"], "the only one that moves a joint: 1 joint");
  EXPECT_NE(run.err.find("using Bend of 2 animations, the only one"), std::string::npos) << run.err;
  const ToolRun given = import({"-o", path("a.anim"), "--clip", "Dolly"});
  EXPECT_TRUE(has_code(given.err, "import-still")) << given.err;
}

TEST_F(AnimationsOfObjectsTest, ACameraAloneHasItsOwn) {
  ASSERT_EQ(import({"--save-cam", path("a.cam")}).exit_code, 0);
  EXPECT_EQ(camera().frame_count(), 91);
  EXPECT_FLOAT_EQ(camera().positions[90].x(), 3);
  const ToolRun given = import({"--save-cam", path("a.cam"), "--clip", "Bend"});
  EXPECT_TRUE(has_code(given.err, "import-camera-clip")) << given.err;
  EXPECT_FLOAT_EQ(camera().positions[30].x(), 0);
}

TEST_F(AnimationsOfObjectsTest, ACameraBesideAMotionHasTheTimeOfTheMotion) {
  const ToolRun run = import({"-o", path("a.anim"), "--save-cam", path("a.cam"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out)["result"]["camera"]["clip"]["name"], "Dolly");
  EXPECT_EQ(camera().frame_count(), 31);
  EXPECT_FLOAT_EQ(camera().positions[30].x(), 1);
}

TEST_F(SceneImportTest, OfSeveralAnimationsTheFirstWithAWarning) {
  put_glb("in.glb", character());
  const ToolRun first = import({"-o", path("a.anim")});
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_TRUE(has_code(first.err, "import-clips")) << first.err;
  EXPECT_NE(first.err.find("Bend/twice"), std::string::npos) << first.err;
  for (const std::string wanted : {"1", "Bend/twice"}) {
    const ToolRun run = import({"-o", path("a.anim"), "--clip", wanted, "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_FALSE(has_code(run.err, "import-clips"));
    EXPECT_EQ(Json::parse(run.out)["result"]["clip"]["name"], "Bend/twice");
  }
  const ToolRun unknown = import({"-o", path("b.anim"), "--clip", "Walk"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_TRUE(has_code(unknown.err, "clip-name")) << unknown.err;
  EXPECT_NE(unknown.err.find("0 (Bend)"), std::string::npos) << unknown.err;
}

TEST_F(SceneImportTest, AllAnimationsNeedAPattern) {
  put_glb("in.glb", character());
  const ToolRun refused = import({"--clip", "all", "-o", path("walk.anim")});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("{clip}"), std::string::npos) << refused.err;
  EXPECT_EQ(listing(), std::vector<std::string>{"in.glb"});
  const ToolRun run = import({"--clip", "all", "-o", path("walk_{clip}.anim"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(listing(),
            (std::vector<std::string>{"in.glb", "walk_Bend.anim", "walk_Bend_twice.anim"}));
  const Json report = Json::parse(run.out);
  EXPECT_EQ(report["result"]["clips"].size(), 2u);
  EXPECT_EQ(report["outputs"].size(), 2u);
  std::filesystem::create_directory(path("out"));
  EXPECT_EQ(import({"--clip", "all", "-o", path("out")}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(path("out/Bend_twice.anim")));
}

TEST_F(SceneImportTest, WhatTheFileDoesNotHoldIsSaid) {
  put_glb("in.glb", square());
  for (const auto& [option, what] :
       std::vector<std::pair<std::string, std::string>>{{"-o", "animation"},
                                                        {"--save-cam", "camera"},
                                                        {"--save-morphs", "morph target"},
                                                        {"--morph-weights", "morph target"}}) {
    const ToolRun run = import({option, path("out")});
    EXPECT_EQ(run.exit_code, 2) << option;
    EXPECT_TRUE(has_code(run.err, "import-missing")) << run.err;
    EXPECT_NE(run.err.find("no " + what), std::string::npos) << run.err;
    EXPECT_EQ(listing(), std::vector<std::string>{"in.glb"});
  }
}

TEST_F(SceneImportTest, ACaptureHasNoCameraAndOneMotion) {
  put("in.bvh", capture(5));
  for (const std::string option : {"--save-cam", "--camera", "--save-morphs", "--skin", "--clip"}) {
    const ToolRun run =
        run_tool("krok-import", {path("in.bvh"), "-o", path("a.anim"), option, path("x")});
    EXPECT_EQ(run.exit_code, 2) << option;
    EXPECT_TRUE(has_code(run.err, "import-missing")) << run.err;
  }
  EXPECT_EQ(run_tool("krok-import", {path("in.bvh"), "--save-model", path("a.model")}).exit_code,
            0);
  EXPECT_EQ(listing(), (std::vector<std::string>{"a.model", "in.bvh"}));
}

TEST_F(SceneImportTest, OptionsForCapturesAreRefused) {
  put_glb("in.glb", rig());
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--positions", "absolute"},
        {"--skip-rest-frame", "yes"},
        {"--repair"},
        {"--skeleton", "a.asf"}}) {
    std::vector<std::string> arguments = {"-o", path("a.anim")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ToolRun run = import(arguments);
    EXPECT_EQ(run.exit_code, 2) << options[0];
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
  }
}

// A capture with a rest pose put before it, by way of a character's file.
TEST_F(SceneImportTest, ARestFrameBeforeTheMotionIsTold) {
  std::string text = get(test::source_folder() + "/samples/captures/walk.bvh");
  const std::size_t line = text.find('\n', text.find("Frame Time:")) + 1;
  std::size_t channels = 0;
  for (std::size_t at = text.find("CHANNELS "); at != std::string::npos;
       at = text.find("CHANNELS ", at + 1)) {
    channels += static_cast<std::size_t>(text[at + 9] - '0');
  }
  std::string row;
  for (std::size_t c = 0; c < channels; ++c) row += c == 1 ? "95 " : "0 ";
  const std::size_t count = text.find("Frames:") + 7;
  const int frames = std::stoi(text.substr(count));
  for (const bool rest : {false, true}) {
    if (rest) {
      text.insert(line, row + "\n");
      text.replace(count, text.find('\n', count) - count, " " + std::to_string(frames + 1));
    }
    put("in.bvh", text);
    const ToolRun made =
        run_tool("krok-export", {path("in.bvh"), "-o", path("in.glb"), "--no-bones"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const ToolRun run = import({"-o", path("a.anim")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(has_code(run.err, "import-rest-frame"), rest) << run.err;
  }
}

TEST_F(SceneImportTest, UnitAndAxesCanBeGiven) {
  put_glb("in.glb", rig());
  const ToolRun run =
      import({"--save-model", path("a.model"), "--unit", "ft", "--forward", "x", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json result = Json::parse(run.out)["result"];
  EXPECT_EQ(result["unit"]["reason"], "as given");
  EXPECT_EQ(result["up"]["choice"], "y");
  const auto file = InputFile::open(path("a.model"));
  const auto model = model::read(file->bytes());
  ASSERT_TRUE(model.ok());
  EXPECT_FLOAT_EQ(static_cast<float>(model->skeleton.reference[1].position.y()), 0.3048f);
  EXPECT_EQ(model->provenance.conversions.size(), 2u);
}

TEST_F(SceneImportTest, WeightsAreATable) {
  put_glb("in.glb", character());
  ASSERT_EQ(import({"--morph-weights", path("w.csv"), "--rate", "1"}).exit_code, 0);
  EXPECT_EQ(get(path("w.csv")), "frame,time,Nose\n0,0,0.5\n1,1,0.5\n");
}

TEST_F(SceneImportTest, TheOutputsAppearTogetherOrNotAtAll) {
  put_glb("in.glb", character());
  const ToolRun run = import(
      {"-o", path("a.anim"), "--save-model", path("a.model"), "--save-cam", path("none/a.cam")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(listing(), std::vector<std::string>{"in.glb"});
  const ToolRun twice = import({"-o", path("a.x"), "--save-cam", path("a.x")});
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_EQ(listing(), std::vector<std::string>{"in.glb"});
}

TEST_F(SceneImportTest, ABufferBesideTheFileIsAnInputToo) {
  GlbBuilder builder = rig();
  Json document = builder.json;
  document["buffers"] = {{{"byteLength", builder.bin.size()}, {"uri", "data.bin"}}};
  put("in.gltf", document.dump());
  put("data.bin",
      std::string(reinterpret_cast<const char*>(builder.bin.data()), builder.bin.size()));
  const ToolRun run = run_tool("krok-import", {path("in.gltf"), "-o", path("a.anim"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json inputs = Json::parse(run.out)["inputs"];
  ASSERT_EQ(inputs.size(), 2u);
  EXPECT_EQ(inputs[1]["path"], path("data.bin"));
}

TEST_F(SceneImportTest, ABatchDoesAnewWhatACompanionChanges) {
  MovingRig rig;
  put("walk.md5anim", md5anim(rig));
  put("walk.md5mesh", md5mesh(rig));
  const auto batch = [&] {
    const ToolRun run = run_tool("krok-import", {path("walk.md5anim"), "--out-dir", path("out"),
                                                 "--save-model", "{name}.model", "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return Json::parse(run.out)["files"][0];
  };
  const Json first = batch();
  ASSERT_EQ(first["inputs"].size(), 2u);
  EXPECT_EQ(first["inputs"][1]["path"], path("walk.md5mesh"));
  EXPECT_EQ(first["result"]["model"]["vertices"], 4);
  EXPECT_EQ(batch()["status"], "unchanged");
  rig.rest[0].translation.x() += 0.5;
  put("walk.md5mesh", md5mesh(rig));
  EXPECT_EQ(batch()["status"], "done");
}

}  // namespace
}  // namespace krok::test
