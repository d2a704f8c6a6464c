// krok-skin --method. Would fail if the method did not reach the vertices, if the default were not
// linear blend, or if an option that cannot be followed were.

#include <nlohmann/json.hpp>

#include "cli/fixture.h"

namespace krok::test {
namespace {

class SkinMethods : public CliTest {
 protected:
  void SetUp() override {
    put("in.bvh", capture(20));
    ASSERT_EQ(tool("krok-import", {"in.bvh", "-o", "in.anim"}).exit_code, 0);
    ASSERT_EQ(tool("krok-body", {"in.anim", "--detail", "low", "-o", "in.model"}).exit_code, 0);
  }

  ToolRun tool(const std::string& name, const std::vector<std::string>& arguments) {
    ToolOptions here;
    here.folder = folder_.string();
    return run_tool(name, arguments, here);
  }

  // Frame 15 by a method ("" for none given); gives the file's name.
  std::string pose(const std::string& method) {
    const std::string name = "pose_" + method + ".glb";
    std::vector<std::string> arguments = {"in.model", "in.anim", "--as", "pose",
                                          "--time",   "15f",     "-o",   name};
    if (!method.empty()) arguments.insert(arguments.end(), {"--method", method});
    EXPECT_EQ(tool("krok-skin", arguments).exit_code, 0);
    return name;
  }

  int difference(const std::string& a, const std::string& b) {
    return tool("krok-diff", {a, b, "--tolerance", "0.1mm"}).exit_code;
  }
};

TEST_F(SkinMethods, DifferAndLinearBlendIsTheDefault) {
  const std::string linear = pose("linear"), dual = pose("dual-quaternion"), rigid = pose("rigid");
  EXPECT_EQ(difference(linear, pose("")), 0);
  EXPECT_EQ(difference(linear, dual), 1);
  EXPECT_EQ(difference(linear, rigid), 1);
  EXPECT_EQ(difference(dual, rigid), 1);
}

TEST_F(SkinMethods, EveryFormOfOutputFollowsThem) {
  for (const std::string method : {"linear", "dual-quaternion", "spherical", "rigid"}) {
    const std::string expected = pose(method);
    ASSERT_EQ(tool("krok-skin", {"in.model", "in.anim", "--as", "frames", "--method", method, "-o",
                                 "f.glb", "-j", "2"})
                  .exit_code,
              0);
    EXPECT_EQ(difference("f_0015.glb", expected), 0) << method;
    ASSERT_EQ(tool("krok-skin", {"in.model", "in.anim", "--as", "baked", "--from", "15f", "--to",
                                 "15f", "--method", method, "-o", "clip.glb"})
                  .exit_code,
              0);
    EXPECT_EQ(difference("clip.glb", expected), 0) << method;
  }
}

// A viewer skins by linear blend whatever was asked for.
TEST_F(SkinMethods, ARigHasNone) {
  for (const std::string method : {"dual-quaternion", "rigid"}) {
    const ToolRun run = tool(
        "krok-skin", {"in.model", "in.anim", "--as", "rig", "--method", method, "-o", "rig.glb"});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
    EXPECT_FALSE(std::filesystem::exists(path("rig.glb")));
  }
  EXPECT_EQ(tool("krok-skin",
                 {"in.model", "in.anim", "--as", "rig", "--method", "linear", "-o", "rig.glb"})
                .exit_code,
            0);
}

TEST_F(SkinMethods, AWordThatIsNoneIsAnsweredWithTheWords) {
  const ToolRun run = tool("krok-skin", {"in.model", "in.anim", "--method", "dq", "-o", "x.glb"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("'dq' is not linear, dual-quaternion, spherical or rigid"),
            std::string::npos)
      << run.err;
}

TEST_F(SkinMethods, TheReportNamesIt) {
  const ToolRun run = tool("krok-skin", {"in.model", "in.anim", "--as", "baked", "--method",
                                         "dual-quaternion", "-o", "x.glb", "--json", "-q"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(json::parse(run.out)["options"]["method"], "dual-quaternion");
}

// Who only means to compress a character would lose its clips without a word.
TEST_F(SkinMethods, AFilesOwnClipsAreNotLostSilently) {
  ASSERT_EQ(tool("krok-skin", {"in.model", "in.anim", "-o", "hero.glb"}).exit_code, 0);
  const ToolRun still = tool("krok-skin", {"hero.glb", "--quantize", "-o", "small.glb"});
  EXPECT_EQ(still.exit_code, 0) << still.err;
  EXPECT_TRUE(has_code(still.err, "scene-still")) << still.err;
  const ToolRun moved =
      tool("krok-skin", {"hero.glb", "hero.glb", "--quantize", "-o", "small.glb"});
  EXPECT_EQ(moved.exit_code, 0) << moved.err;
  EXPECT_FALSE(has_code(moved.err, "scene-still")) << moved.err;
}

}  // namespace
}  // namespace krok::test
