// Characters of the corpus in a pose, by each method, against a computation with numpy that reads
// the glTF itself and shares no code with Krok (skin_by_numpy.py). If it fails, a method moves
// vertices elsewhere than its formula does, or weights reach other joints than the file says.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "cli/fixture.h"

namespace krok::test {
namespace {

const std::string kPython = "/usr/bin/python3";  // Debian's, for it is Debian's numpy
const std::string kScript = KROK_SOURCE_DIR "/tests/corpus/skin/skin_by_numpy.py";

class SkinnedByNumpy : public CliTest {
 protected:
  void SetUp() override {
    if (run({kPython, "-c", "import numpy"}).exit_code != 0) {
      GTEST_SKIP() << "skipped: there is no numpy";
    }
  }

  // Holds frame `frame` of `rig`'s motion, which is the moment `seconds` in `rig`, against what
  // krok-skin makes of in.model and in.anim.
  void expect_agreement(const std::string& rig, const std::string& frame,
                        const std::string& seconds, double tolerance) {
    for (const std::string method : {"linear", "dual-quaternion", "rigid"}) {
      const ToolRun skin =
          run_tool("krok-skin", {path("in.model"), path("in.anim"), "--as", "pose", "--time", frame,
                                 "--method", method, "-o", path("pose.glb")});
      ASSERT_EQ(skin.exit_code, 0) << skin.err;
      const ToolRun numpy = run({kPython, kScript, rig, seconds, method, path("pose.glb")});
      ASSERT_EQ(numpy.exit_code, 0) << numpy.err;
      const auto line = numpy.out.find('\n');
      ASSERT_NE(line, std::string::npos) << numpy.out;
      EXPECT_LT(std::strtod(numpy.out.c_str() + line, nullptr), tolerance) << method;
    }
  }
};

TEST_F(SkinnedByNumpy, AGltfOfTheCorpus) {
  const std::string rig = KROK_CORPUS_DIR "/other/gltf/rigged_simple.gltf";
  if (!std::filesystem::exists(rig)) GTEST_SKIP() << "skipped: no corpus here";
  ASSERT_EQ(
      run_tool("krok-import", {rig, "-o", path("in.anim"), "--model", path("in.model")}).exit_code,
      0);
  // Its animation begins at 1/24 s.
  expect_agreement(rig, "24f", "1.0416666", 2e-6);
}

// 2,464 vertices on up to 6 joints each, of 14. Krok's glTF of it stands in for one of its own.
TEST_F(SkinnedByNumpy, AnFbxOfTheCorpus) {
  const std::string rig = KROK_CORPUS_DIR "/other/assimp/animation_with_skeleton.fbx";
  if (!std::filesystem::exists(rig)) GTEST_SKIP() << "skipped: no corpus here";
  ASSERT_EQ(
      run_tool("krok-import", {rig, "-o", path("in.anim"), "--model", path("in.model")}).exit_code,
      0);
  const ToolRun skin = run_tool(
      "krok-skin", {path("in.model"), path("in.anim"), "--as", "rig", "-o", path("rig.glb")});
  ASSERT_EQ(skin.exit_code, 0) << skin.err;
  // The figure is 7.5 m tall.
  expect_agreement(path("rig.glb"), "12f", "0.5", 2e-5);
}

}  // namespace
}  // namespace krok::test
