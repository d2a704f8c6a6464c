// krok-fit of sculpted poses, krok-skin --correctives and --twist-joints. Would fail if correctives
// did not reach what is written, or differed between rigs, frames and poses; if twist joints were
// not in the file and its motion; or if files that do not fit were taken.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/fixture.h"

namespace krok::test {
namespace {

class SkinCorrectives : public CliTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({test::make_walk(), "--steps", "2", "--rate", "30", "-q", "-o", path("in.bvh")})
                  .exit_code,
              0);
    ASSERT_EQ(tool("krok-import", {"in.bvh", "-o", "in.anim"}).exit_code, 0);
    ASSERT_EQ(tool("krok-body", {"in.anim", "--detail", "low", "-o", "in.model"}).exit_code, 0);
  }

  ToolRun tool(const std::string& name, const std::vector<std::string>& arguments) const {
    return run_here(name, arguments);
  }

  // A description whose sculpts are dual quaternion skinning.
  std::string description(const std::string& joint) {
    EXPECT_EQ(tool("krok-skin", {"in.model", "in.anim", "--as", "frames", "--method",
                                 "dual-quaternion", "-o", "s.obj"})
                  .exit_code,
              0);
    const auto pose = [](int frame) {
      return fmt::format(R"({{"motion": "in.anim", "frame": {0}, "shape": "s_{0:04}.obj"}})",
                         frame);
    };
    return fmt::format(
        "{{\"schema\": \"krok.corrective-poses/1\", \"model\": \"in.model\", \"joints\": [\n"
        "  {{\"joint\": \"{}\", \"examples\": [{}],\n   \"held_out\": [{}]}}]}}",
        joint, pose(12), pose(7));
  }
};

TEST_F(SkinCorrectives, AreFittedAndWritten) {
  put("fit.json", description("LeftUpLeg"));
  const ToolRun fit = tool("krok-fit", {"fit.json", "-o", "in.correctives", "--json=fit.report"});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  const auto report = nlohmann::json::parse(get(path("fit.report")));
  const auto& joint = report["result"]["joints"][0];
  EXPECT_EQ(joint["targets"], 1);
  EXPECT_EQ(joint["held_out"]["poses"], 1);
  EXPECT_LE(joint["poses"][0]["corrected"]["root_mean_square"].get<double>(),
            joint["poses"][0]["skinned"]["root_mean_square"].get<double>());
  for (const char* as : {"pose", "baked", "rig"}) {
    std::vector<std::string> arguments = {
        "in.model", "in.anim", "--correctives", "in.correctives", "--as", as, "-o", "out.glb"};
    ASSERT_EQ(tool("krok-skin", arguments).exit_code, 0) << as;
  }
  // The rig, played, is the frames that were skinned here.
  ASSERT_EQ(tool("krok-skin", {"in.model", "in.anim", "--correctives", "in.correctives", "--as",
                               "baked", "-o", "baked.glb"})
                .exit_code,
            0);
  EXPECT_EQ(tool("krok-diff", {"out.glb", "baked.glb", "--tolerance", "0.1mm"}).exit_code, 0);
  const ToolRun other = tool("krok-skin", {"in.model", "in.anim", "--correctives", "in.correctives",
                                           "--as", "baked", "--method", "rigid", "-o", "x.glb"});
  EXPECT_TRUE(has_code(other.err, "skin-correctives-method")) << other.err;
  ASSERT_EQ(tool("krok-body", {"in.anim", "-o", "finer.model"}).exit_code, 0);
  const ToolRun finer = tool(
      "krok-skin", {"finer.model", "in.anim", "--correctives", "in.correctives", "-o", "x.glb"});
  EXPECT_EQ(finer.exit_code, 2);
  EXPECT_TRUE(has_code(finer.err, "skin-correctives")) << finer.err;
}

TEST_F(SkinCorrectives, MistakesAreToldWithTheirPlace) {
  const std::string good = description("LeftUpLeg");
  const auto error_of = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    put("fit.json", text);
    const ToolRun run = tool("krok-fit", {"fit.json", "-o", "in.correctives"});
    EXPECT_EQ(run.exit_code, 2);
    return run.err;
  };
  EXPECT_NE(error_of("\"frame\": 7", "\"frame\": 70").find("fit.json:3:"), std::string::npos);
  EXPECT_NE(error_of("LeftUpLeg", "Nobody").find("fit.json:2:"), std::string::npos);
  EXPECT_TRUE(has_code(error_of("s_0007.obj", "s_0099.obj"), "file-missing"));
  put("fit.json", good);
  EXPECT_EQ(tool("krok-fit", {"fit.json", "-o", "in.steps"}).exit_code, 2);
  EXPECT_EQ(tool("krok-fit", {"fit.json", "--kernel", "linear", "-o", "a.correctives"}).exit_code,
            2);
}

TEST_F(SkinCorrectives, TwistJointsAreInModelsAndRigs) {
  ASSERT_EQ(tool("krok-skin",
                 {"in.model", "in.anim", "--twist-joints", "upper_arm=2,shin", "-o", "rig.glb"})
                .exit_code,
            0);
  ASSERT_EQ(tool("krok-body", {"in.anim", "--detail", "low", "--twist-joints", "upper_arm=2,shin",
                               "-o", "twist.model"})
                .exit_code,
            0);
  ASSERT_EQ(tool("krok-skin", {"twist.model", "in.anim", "-o", "same.glb"}).exit_code, 0);
  EXPECT_EQ(tool("krok-diff", {"rig.glb", "same.glb", "--tolerance", "0.01mm"}).exit_code, 0);
  EXPECT_NE(get(path("rig.glb")).find("LeftArm_untwist2"), std::string::npos);
  EXPECT_NE(get(path("rig.glb")).find("RightLeg_twist1"), std::string::npos);
  for (const char* wrong : {"arm", "shin=9", "shin,shin", "shin=", ""}) {
    EXPECT_EQ(tool("krok-skin", {"in.model", "in.anim", "--twist-joints", wrong, "-o", "x.glb"})
                  .exit_code,
              2)
        << wrong;
  }
}

}  // namespace
}  // namespace krok::test
