// Characters of the corpus in a pose, by each method, against a computation with numpy that reads
// the glTF itself and shares no code with Krok (skin_by_numpy.py), and against three.js's own
// skinning. If these fail, a method moves vertices or normals elsewhere than its formula does,
// weights reach other joints than the file says, or what krok-skin writes is no sound glTF.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "cli/fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

const std::string kPython = "/usr/bin/python3";  // Debian's, for it is Debian's numpy
const std::string kScripts = test::source_folder() + "/tests/corpus/skin/";
const fs::path kTests = test::source_folder() + "/tests";
const fs::path kFbx = test::corpus_folder() + "/other/assimp/animation_with_skeleton.fbx";

// The glTF files of the corpus that have a skin and an animation.
std::vector<fs::path> skinned_gltf() {
  std::vector<fs::path> result;
  const fs::path folder = test::corpus_folder() + "/other";
  if (!fs::exists(folder)) return result;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") continue;
    std::ostringstream text;
    text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    const bool moves = text.str().find("\"animations\"") != std::string::npos;
    if (moves && text.str().find("\"skins\"") != std::string::npos) result.push_back(entry.path());
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<double> numbers(const std::string& lines) {
  std::vector<double> result;
  std::istringstream text(lines);
  for (std::string line; std::getline(text, line);) {
    if (line.find("vertices") == std::string::npos) result.push_back(std::stod(line));
  }
  return result;
}

class SkinnedByOthers : public CliTest {
 protected:
  void import(const fs::path& rig) {
    const ToolRun run = run_tool(
        "krok-import", {rig.string(), "-o", path("in.anim"), "--save-model", path("in.model")});
    ASSERT_EQ(run.exit_code, 0) << rig << "\n" << run.err;
  }
  void skin(const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {path("in.model"), path("in.anim")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ToolRun run = run_tool("krok-skin", arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  bool has_numpy() { return run({kPython, "-c", "import numpy"}).exit_code == 0; }
  static bool has_module(const std::string& name) {
    return fs::exists(kTests / "node_modules" / name);
  }

  // Holds the moment `seconds` of `rig`'s motion, in.anim's as well, against numpy. Metres.
  void expect_agreement(const std::string& rig, const std::string& seconds, double tolerance) {
    for (const std::string method : {"linear", "dual-quaternion", "rigid"}) {
      ASSERT_NO_FATAL_FAILURE(skin(
          {"--as", "pose", "--time", seconds + "s", "--method", method, "-o", path("pose.glb")}));
      const ToolRun numpy =
          run({kPython, kScripts + "skin_by_numpy.py", rig, seconds, method, path("pose.glb")});
      ASSERT_EQ(numpy.exit_code, 0) << numpy.err;
      const auto [distance, angle] = [&] {
        const auto found = numbers(numpy.out);
        return std::pair(found.at(0), found.at(1));
      }();
      EXPECT_LT(distance, tolerance) << rig << " " << method;
      EXPECT_LT(angle, 0.01) << rig << " " << method;
    }
  }
};

TEST_F(SkinnedByOthers, NumpyPutsTheVerticesOfGltfFilesThere) {
  const auto rigs = skinned_gltf();
  if (rigs.empty()) GTEST_SKIP() << "skipped: no corpus here";
  if (!has_numpy()) GTEST_SKIP() << "skipped: there is no numpy";
  for (const fs::path& rig : rigs) {
    ASSERT_NO_FATAL_FAILURE(import(rig));
    for (const char* seconds : {"0", "0.5", "1"}) expect_agreement(rig.string(), seconds, 1e-5);
  }
}

// 2,464 vertices on up to 6 joints each, of 14. Krok's glTF of it stands in for one of its own.
TEST_F(SkinnedByOthers, NumpyPutsTheVerticesOfAnFbxThere) {
  if (!fs::exists(kFbx)) GTEST_SKIP() << "skipped: no corpus here";
  if (!has_numpy()) GTEST_SKIP() << "skipped: there is no numpy";
  ASSERT_NO_FATAL_FAILURE(import(kFbx));
  ASSERT_NO_FATAL_FAILURE(skin({"--as", "rig", "-o", path("rig.glb")}));
  // The figure is 7.5 m tall.
  expect_agreement(path("rig.glb"), "0.5", 2e-5);
}

TEST_F(SkinnedByOthers, ThreeJsSkinsAsLinearBlendDoes) {
  const auto rigs = skinned_gltf();
  if (rigs.empty()) GTEST_SKIP() << "skipped: no corpus here";
  if (!has_module("three")) GTEST_SKIP() << "skipped: no three.js in " << kTests << "; run npm ci";
  for (const fs::path& rig : rigs) {
    ASSERT_NO_FATAL_FAILURE(import(rig));
    for (const std::string seconds : {"0", "0.5", "1"}) {
      ASSERT_NO_FATAL_FAILURE(
          skin({"--as", "pose", "--time", seconds + "s", "-o", path("pose.glb")}));
      const ToolRun three = run({"/usr/bin/env", "node", kScripts + "skin_by_three.mjs",
                                 rig.string(), seconds, path("pose.glb")});
      ASSERT_EQ(three.exit_code, 0) << three.err;
      EXPECT_LT(std::stod(three.out), 1e-5) << rig << " at " << seconds << " s";
    }
  }
}

TEST_F(SkinnedByOthers, WhatIsWrittenIsValid) {
  auto rigs = skinned_gltf();
  if (rigs.empty()) GTEST_SKIP() << "skipped: no corpus here";
  if (!has_module("gltf-validator")) {
    GTEST_SKIP() << "skipped: no gltf-validator in " << kTests << "; run npm ci there";
  }
  rigs.push_back(kFbx);
  fs::create_directory(path("out"));
  int files = 0;
  for (const fs::path& rig : rigs) {
    ASSERT_NO_FATAL_FAILURE(import(rig));
    for (const std::string as : {"baked", "pose", "rig", "frames"}) {
      for (const std::string method : {"linear", "dual-quaternion", "rigid"}) {
        if (as == "rig" && method != "linear") continue;
        std::vector<std::string> options = {
            "--as", as, "--method", method, "-o", path("out/" + std::to_string(files++) + ".glb")};
        if (as == "frames") options.insert(options.end(), {"--every", "20"});
        ASSERT_NO_FATAL_FAILURE(skin(options));
      }
    }
  }
  const ToolRun judged =
      run({"/usr/bin/env", "node", (kTests / "golden/validate_gltf.mjs").string(), path("out")});
  EXPECT_EQ(judged.exit_code, 0) << judged.out << judged.err;
  EXPECT_THAT(judged.out, testing::HasSubstr(" files, 0 with errors or warnings"));
}

}  // namespace
}  // namespace krok::test
