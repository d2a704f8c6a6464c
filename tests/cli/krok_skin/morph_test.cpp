// krok-skin --morph, --weights and the files that are no glTF. Would fail if shapes did not reach
// the vertices before the skeleton moves them, if weights were taken at other moments than the
// motion's, or if a file held other vertices than the glTF of the same moment.

#include <nlohmann/json.hpp>

#include "cli/bent_body.h"

namespace krok::test {
namespace {

class SkinMorphs : public BentBody {
 protected:
  void SetUp() override {
    BentBody::SetUp();
    put("full.json", weights("[0, 1]"));
    put("rising.csv", "frame,time,bent\n0,0,0\n1,0.5,1\n");
  }

  static std::string weights(const std::string& keys, const std::string& target = "bent") {
    return R"({"schema": "krok.weights/1", "curves": [{"target": ")" + target + R"(", "keys": [)" +
           keys + "]}]}\n";
  }
};

TEST_F(SkinMorphs, AFullTargetInTheReferencePoseIsTheTarget) {
  tool("krok-skin", {"in.model", "--morph", "bent.exr", "--weights", "full.json", "--as", "pose",
                     "-o", "morphed.glb"});
  expect_same("morphed.glb", "bent.glb");
}

TEST_F(SkinMorphs, TheSkeletonMovesTheChangedShape) {
  const std::vector<std::string> morph = {"in.model", "in.anim",   "--morph",
                                          "bent.exr", "--weights", "full.json"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), morph.begin(), morph.end());
    return more;
  };
  tool("krok-skin", with({"--as", "rig", "-o", "rig.glb"}));
  tool("krok-skin", with({"--as", "baked", "-o", "baked.glb"}));
  expect_same("rig.glb", "baked.glb");  // the viewer's arithmetic against the tool's
  tool("krok-skin", with({"--as", "pose", "--time", "10f", "-o", "morphed.glb"}));
  tool("krok-skin", {"in.model", "in.anim", "--as", "pose", "--time", "10f", "-o", "plain.glb"});
  tool("krok-diff", {"morphed.glb", "plain.glb"}, 1);
}

// A face that moves in the file was still in the result.
TEST_F(SkinMorphs, AFaceMovesAsInTheFilesAnimation) {
  const std::vector<std::string> moving = {"in.model", "in.anim",   "--morph",
                                           "bent.exr", "--weights", "rising.csv"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), moving.begin(), moving.end());
    return more;
  };
  tool("krok-skin", with({"-o", "moving.glb"}));
  tool("krok-skin", {"moving.glb", "in=moving.glb", "-o", "out.glb"});
  expect_same("out.glb", "moving.glb");
  // Of a part, and for another motion's file, whose face rests beside it.
  tool("krok-skin", with({"--from", "2f", "--every", "2", "-o", "part.glb"}));
  tool("krok-skin",
       {"moving.glb", "in=moving.glb", "--from", "2f", "--every", "2", "-o", "out.glb"});
  expect_same("out.glb", "part.glb");
  tool("krok-skin", {"moving.glb", "moving.glb", "in.anim", "-o", "out.glb"});
  tool("krok-skin", {"in.model", "in.anim", "--morph", "bent.exr", "-o", "still.glb"});
  tool("krok-diff", {"out.glb#1", "still.glb", "--match", "order"});
  tool("krok-skin", {"in.model", "moving.glb", "-o", "out.glb"});  // without a face
}

// krok-morph wrote a grey mesh of a file with materials.
TEST_F(SkinMorphs, WhatIsBakedOfAFileKeepsItsMaterials) {
  tool("krok-skin", {"in.model", "-o", "base.gltf"});
  json base = json::parse(get(path("base.gltf")));
  base["materials"][0]["name"] = "leather";
  put("base.gltf", base.dump());
  for (const char* as : {"targets", "clip"}) {
    tool("krok-morph",
         {"bake", "base.gltf", "bent.exr", "--weights", "full.json", "--as", as, "-o", "out.gltf"});
    EXPECT_EQ(json::parse(get(path("out.gltf")))["materials"][0]["name"], "leather") << as;
  }
}

TEST_F(SkinMorphs, WeightsAreTakenAtTheMotionsMoments) {
  const std::vector<std::string> rising = {"in.model", "in.anim",   "--morph",
                                           "bent.exr", "--weights", "rising.csv"};
  const auto pose = [&](const std::vector<std::string>& time, const std::string& name) {
    std::vector<std::string> arguments = rising;
    arguments.insert(arguments.end(), time.begin(), time.end());
    arguments.insert(arguments.end(), {"-o", name});
    tool("krok-skin", arguments);
  };
  pose({"--as", "pose", "--time", "8f"}, "pose.glb");
  pose({"--as", "frames", "--from", "4f", "--every", "4"}, "part.glb");
  expect_same("part_0008.glb", "pose.glb");
}

TEST_F(SkinMorphs, AStillActorIsHeldAsLongAsTheWeightsLast) {
  put("half_second.json", weights("[0, 0], [0.5, 1]"));
  const ToolRun run = tool("krok-skin", {"in.model", "--morph", "bent.exr", "--weights",
                                         "half_second.json", "-o", "still.glb", "--json"});
  EXPECT_EQ(nlohmann::json::parse(run.out)["result"]["frames"],
            16);  // half a second at 30 a second
}

TEST_F(SkinMorphs, PointCachesAndObjFilesHoldTheSameVertices) {
  tool("krok-skin", {"in.model", "in.anim", "-o", "walk.pc2", "-j", "1"});
  tool("krok-skin", {"in.model", "in.anim", "-o", "again.pc2", "-j", "3"});
  EXPECT_EQ(get(path("walk.pc2")), get(path("again.pc2")));
  tool("krok-skin", {"in.model", "in.anim", "--as", "frames", "-o", "f.obj"});
  // An OBJ file packed as a target and shown in full is the glTF of the same frame.
  tool("krok-morph", {"pack", "in.model", "f_0015.obj", "-o", "f.exr"});
  put("f.json", weights("[0, 1]", "f_0015"));
  tool("krok-skin",
       {"in.model", "--morph", "f.exr", "--weights", "f.json", "--as", "pose", "-o", "f15.glb"});
  expect_same("f15.glb", "bent.glb");
}

// The error of each target that is active adds up; krok-diff evaluates the files as a viewer does.
TEST_F(SkinMorphs, TheErrorOfSmallFilesIsThatOfTheMovedShapes) {
  tool("krok-skin", {"in.model", "in.anim", "--as", "frames", "--every", "3", "-o", "f.obj"});
  tool("krok-morph", {"pack", "in.model", "f_0000.obj", "f_0003.obj", "f_0006.obj", "f_0009.obj",
                      "f_0012.obj", "-o", "five.exr"});
  put("five.csv",
      "frame,time,f_0000,f_0003,f_0006,f_0009,f_0012\n0,0,1,-1,1,-1,1\n1,0.5,2,-2,2,-2,1\n");
  const auto skin = [&](std::vector<std::string> more, int expected) {
    more.insert(more.begin(), {"in.model", "in.anim", "--morph", "five.exr", "--weights",
                               "five.csv", "--json", "-q"});
    return nlohmann::json::parse(tool("krok-skin", more, expected).out)["result"];
  };
  skin({"-o", "full.glb"}, 0);
  for (const char* reduce : {"1mm", "0.3mm", "0.01mm"}) {
    const bool can = reduce != std::string("0.01mm");
    const auto rig =
        skin({"-o", "small.glb", "--reduce", reduce, "--quantize"}, can ? 0 : 1)["rig"];
    EXPECT_EQ(rig["within_tolerance"], can);
    const auto seen = nlohmann::json::parse(
        tool("krok-diff", {"full.glb", "small.glb", "--match", "order", "--json"}, 1).out);
    const double largest = seen["result"]["measures"][0]["largest"];
    EXPECT_NEAR(largest, rig["largest_error"].get<double>(), 0.01 * largest) << reduce;
  }
}

TEST_F(SkinMorphs, WhatCannotBeIsToldAndNothingIsWritten) {
  put("wrong.json", weights("[0, 1]", "bend"));
  const std::string told =
      tool("krok-skin",
           {"in.model", "in.anim", "--morph", "bent.exr", "--weights", "wrong.json", "-o", "x.glb"},
           2)
          .err;
  EXPECT_NE(told.find("wrong.json:1:"), std::string::npos) << told;
  EXPECT_NE(told.find("bent"), std::string::npos) << told;
  tool("krok-skin", {"in.model", "in.anim", "--weights", "full.json", "-o", "x.glb"}, 2);
  tool("krok-skin", {"in.model", "in.anim", "--morph", "bent.exr", "--as", "baked", "-o", "x.glb"},
       2);
  tool("krok-skin", {"in.model", "in.anim", "--as", "rig", "-o", "x.pc2"}, 2);
  tool("krok-skin", {"in.model", "in.anim", "--as", "baked", "-o", "x.obj"}, 2);
  // Targets of another mesh.
  tool("krok-body", {"in.anim", "--detail", "high", "-o", "other.model"});
  const std::string other = tool("krok-skin",
                                 {"other.model", "in.anim", "--morph", "bent.exr", "--weights",
                                  "full.json", "-o", "x.glb"},
                                 2)
                                .err;
  EXPECT_NE(other.find("bent.exr"), std::string::npos) << other;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    EXPECT_NE(entry.path().stem(), "x") << entry.path();
  }
}

}  // namespace
}  // namespace krok::test
