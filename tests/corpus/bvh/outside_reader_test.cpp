// What krok-export writes as BVH, read by three.js's loader: the world positions of all joints in
// all frames are those of the motion. Would break: a channel order, an angle or an OFFSET that only
// our own reader takes for what was meant.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "support/run_tool.h"
#include "support/this_build.h"

namespace krok {
namespace {

namespace fs = std::filesystem;

class OutsideReader : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path three = fs::path(test::source_folder()) / "tests/node_modules/three";
    if (!fs::exists(three)) {
      GTEST_SKIP() << "skipped: no " << three.string() << "; run npm ci in tests/";
    }
    folder_ = fs::path(testing::TempDir()) / ("krok_outside_reader_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static void tool(const std::string& name, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), test::tools_folder() + "/" + name);
    const auto done = test::run(arguments);
    ASSERT_EQ(done.exit_code, 0) << done.err;
  }

  // Imports a capture, with orientations as exact as floats are, and exports it with `options`.
  void convert(const std::string& capture, std::vector<std::string> options) {
    tool("krok-import", {"-q", "--orientation", "xyzw", capture, "-o", path("a.anim")});
    options.insert(options.end(), {"-q", path("a.anim"), "-o", path("a.bvh")});
    tool("krok-export", options);
    tool("krok-export", {"-q", path("a.anim"), "-o", path("a.csv")});
  }

  test::ToolRun judge(const std::string& metres, const std::string& tolerance) const {
    return test::run({"/usr/bin/env", "node",
                      test::source_folder() + "/tests/corpus/bvh/three_bvh.mjs", path("a.bvh"),
                      path("a.csv"), metres, tolerance});
  }

  fs::path folder_;
};

// A body with a limb that turns every way, a bone of no length and two End Sites.
std::string small_capture() {
  std::string text =
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation "
      "Xrotation Yrotation\nJOINT Knot\n{\nOFFSET 0 0 0\nCHANNELS 3 Yrotation Xrotation Zrotation\n"
      "JOINT Arm\n{\nOFFSET 0.3 0.4 -0.1\nCHANNELS 3 Xrotation Yrotation Zrotation\nEnd Site\n{\n"
      "OFFSET 0.2 0 0.1\n}\n}\n}\nJOINT Leg\n{\nOFFSET 0.1 -0.2 0\nCHANNELS 3 Zrotation Yrotation "
      "Xrotation\nEnd Site\n{\nOFFSET 0 -0.7 0\n}\n}\n}\nMOTION\nFrames: 40\nFrame Time: 0.02\n";
  for (int frame = 0; frame < 40; ++frame) {
    for (int channel = 0; channel < 3; ++channel) text += std::to_string(0.01 * frame) + " ";
    for (int channel = 3; channel < 15; ++channel) {
      text += std::to_string((17 + channel) * frame % 360 - 180) + " ";
    }
    text += "\n";
  }
  return text;
}

TEST_F(OutsideReader, SeesTheSameMotionInEveryOrderAndUnit) {
  std::ofstream(path("in.bvh")) << small_capture();
  struct Way {
    const char *order, *unit, *metres;
  };
  for (const Way& way : {Way{"ZXY", "cm", "0.01"}, Way{"XYZ", "m", "1"}, Way{"yzx", "mm", "0.001"},
                         Way{"ZYX", "in", "0.0254"}}) {
    convert(path("in.bvh"), {"--order", way.order, "--unit", way.unit});
    const auto judged = judge(way.metres, "1e-6");
    EXPECT_EQ(judged.exit_code, 0) << way.order << ": " << judged.out << judged.err;
  }
  // The judge can say no.
  EXPECT_EQ(judge("0.025", "1e-6").exit_code, 1);
  convert(path("in.bvh"), {"--digits", "2"});
  EXPECT_EQ(judge("0.01", "1e-6").exit_code, 1);
  EXPECT_EQ(judge("0.01", "1e-3").exit_code, 0);
}

TEST_F(OutsideReader, SeesTheSameMotionInCaptures) {
  const fs::path corpus = fs::path(test::corpus_folder()) / "bvh";
  if (!fs::exists(corpus)) GTEST_SKIP() << "skipped: no corpus at " << corpus.string();
  for (const char* name : {"ipi_smartbody/Center.bvh", "pybvh/bvh_test3.bvh",
                           "makehuman/zombieWalk1.bvh", "iclone_cmu/002_03.bvh"}) {
    convert((corpus / name).string(), {});
    const auto judged = judge("0.01", "2e-6");
    EXPECT_EQ(judged.exit_code, 0) << name << ": " << judged.out << judged.err;
  }
}

}  // namespace
}  // namespace krok
