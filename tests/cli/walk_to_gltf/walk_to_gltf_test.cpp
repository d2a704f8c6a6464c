// If these fail, `make demo` fails: the first thing that a newcomer runs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "cli/fixture.h"
#include "cli/made_once.h"
#include "support/folder_test.h"
#include "support/run_tool.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

using test::ToolRun;

const std::string kWalkToGltf = test::source_folder() + "/samples/walk_to_gltf";

class WalkToGltf : public test::FolderTest {
 protected:
  ToolRun shell(const std::string& command) {
    test::ToolOptions options;
    options.folder = folder_.string();
    options.timeout = 600;
    return test::run({"/bin/sh", "-c", command}, options);
  }
  ToolRun demo(const std::string& arguments) {
    return shell("KROK_BIN='" + test::tools_folder() + "' '" + test::source_folder() +
                 "/samples/walk_to_gltf/run.sh' " + arguments);
  }
  // A long capture whose name, and its folder's, have spaces, once for all tests.
  static Made long_capture() {
    return made_once("long capture", kWalkToGltf, [](const fs::path& folder) {
      test::ToolOptions options;
      options.folder = folder.string();
      options.timeout = 600;
      return test::run(
          {"/bin/sh", "-c",
           "'" + test::make_walk() + "' --steps 40 --rate 120 -o 'my long take.bvh' && KROK_BIN='" +
               test::tools_folder() + "' '" + kWalkToGltf +
               "/run.sh' 'my long take.bvh' 'a folder/of mine'"},
          options);
    });
  }
  static void expect_result(const fs::path& base) {
    for (const char* end :
         {".anim", ".model", "_rig.glb", "_clip.glb", "_motion.csv", "_motion.bvh", "_motion.glb",
          ".html", ".svg", "_sheet.png", "_strip.png"}) {
      const fs::path result = base.string() + end;
      ASSERT_TRUE(fs::exists(result)) << result;
      EXPECT_GT(fs::file_size(result), 1000u) << result;
    }
  }

  // Every glTF below `base` before the Khronos validator, which `make test` installs.
  void expect_valid(const std::string& base) {
    const fs::path tests = fs::path(test::source_folder()) / "tests";
    if (!fs::exists(tests / "node_modules/gltf-validator")) {
      GTEST_SKIP() << "skipped: no gltf-validator in " << tests << "; run npm ci there";
    }
    const ToolRun judged = shell("node '" + (tests / "golden/validate_gltf.mjs").string() + "' " +
                                 base + "_rig.glb " + base + "_clip.glb " + base + "_motion.glb");
    EXPECT_EQ(judged.exit_code, 0) << judged.out << judged.err;
  }
};

TEST_F(WalkToGltf, RunsOnTheSampleWithoutArguments) {
  const ToolRun run = demo("");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  expect_result(folder_ / "out/demo/walk");
  EXPECT_THAT(run.out, HasSubstr("out/demo/walk_rig.glb"));
  EXPECT_THAT(run.out, HasSubstr("the same within 0.01 mm"));
  expect_valid("out/demo/walk");
}

TEST_F(WalkToGltf, TakesNamesWithSpaces) {
  const auto [folder, run] = long_capture();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  expect_result(folder / "a folder/of mine/my long take");
}

TEST_F(WalkToGltf, ALongCaptureIsBakedInPartAndSaysSo) {
  const auto [folder, run] = long_capture();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("too long to be baked whole: the first"));
  EXPECT_TRUE(fs::exists(folder / "a folder/of mine/my long take_rig_part.glb"));
  expect_valid("'" + (folder / "a folder/of mine/my long take").string() + "'");
}

TEST_F(WalkToGltf, TheFirstFailureEndsItWithTheToolsOwnMessage) {
  const ToolRun missing = demo("nothing.bvh");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("[file-missing]"));
  EXPECT_THAT(missing.out, Not(HasSubstr("Done")));

  std::ofstream(folder_ / "still.bvh")
      << "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition "
         "Zrotation "
         "Xrotation Yrotation\nJOINT Spine\n{\nOFFSET 0 20 0\nCHANNELS 3 Zrotation Xrotation "
         "Yrotation\nEnd Site\n{\nOFFSET 0 30 0\n}\n}\n}\nMOTION\nFrames: 0\nFrame Time: "
         "0.0333333\n";
  const ToolRun still = demo("still.bvh");
  EXPECT_EQ(still.exit_code, 2);
  EXPECT_THAT(still.err, HasSubstr("no frames"));
  EXPECT_THAT(still.out, Not(HasSubstr("Done")));
}

TEST_F(WalkToGltf, ToolsThatAreNotThereAreNamed) {
  const ToolRun run =
      shell("KROK_BIN=/nowhere '" + test::source_folder() + "/samples/walk_to_gltf/run.sh'");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("no krok-import in /nowhere"));
  EXPECT_THAT(run.err, HasSubstr("hint:"));
}

}  // namespace
}  // namespace krok::test
