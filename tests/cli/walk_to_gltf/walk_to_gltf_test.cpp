// If these fail, `make demo` fails: the first thing that a newcomer runs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace krok {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

class WalkToGltf : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("krok_demo_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Outcome shell(const std::string& command) {
    const std::string whole =
        "cd '" + folder_.string() + "' && " + command + " > out.txt 2> err.txt";
    const int status = std::system(whole.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of("out.txt"), text_of("err.txt")};
  }
  Outcome demo(const std::string& arguments) {
    return shell("KROK_BIN='" KROK_BIN_DIR "' '" KROK_SOURCE_DIR "/samples/walk_to_gltf/run.sh' " +
                 arguments);
  }
  std::string text_of(const std::string& name) {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void expect_result(const std::string& base) {
    for (const char* end : {".anim", ".model", "_rig.glb", "_clip.glb", "_motion.csv",
                            "_motion.bvh", "_motion.glb"}) {
      const fs::path path = folder_ / (base + end);
      ASSERT_TRUE(fs::exists(path)) << path;
      EXPECT_GT(fs::file_size(path), 1000u) << path;
    }
  }

  // Every glTF below `base` before the Khronos validator, which `make test` installs.
  void expect_valid(const std::string& base) {
    const fs::path tests = fs::path(KROK_SOURCE_DIR) / "tests";
    if (!fs::exists(tests / "node_modules/gltf-validator")) {
      GTEST_SKIP() << "skipped: no gltf-validator in " << tests << "; run npm ci there";
    }
    const Outcome judged = shell("node '" + (tests / "golden/validate_gltf.mjs").string() + "' " +
                                 base + "_rig.glb " + base + "_clip.glb " + base + "_motion.glb");
    EXPECT_EQ(judged.exit_code, 0) << judged.out << judged.err;
  }

  fs::path folder_;
};

TEST_F(WalkToGltf, RunsOnTheSampleWithoutArguments) {
  const Outcome run = demo("");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  expect_result("out/demo/walk");
  EXPECT_THAT(run.out, HasSubstr("out/demo/walk_rig.glb"));
  EXPECT_THAT(run.out, HasSubstr("the same within 0.01 mm"));
  expect_valid("out/demo/walk");
}

TEST_F(WalkToGltf, TakesNamesWithSpaces) {
  fs::copy(fs::path(KROK_SOURCE_DIR) / "samples/captures/turn.bvh", folder_ / "my first take.bvh");
  const Outcome run = demo("'my first take.bvh' 'a folder/of mine'");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  expect_result("a folder/of mine/my first take");
}

TEST_F(WalkToGltf, ALongCaptureIsBakedInPartAndSaysSo) {
  ASSERT_EQ(shell("'" KROK_MAKE_WALK "' --steps 40 --rate 120 -o long.bvh").exit_code, 0);
  const Outcome run = demo("long.bvh result");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  expect_result("result/long");
  EXPECT_THAT(run.out, HasSubstr("too long to be baked whole: the first"));
  EXPECT_TRUE(fs::exists(folder_ / "result/long_rig_part.glb"));
  expect_valid("result/long");
}

TEST_F(WalkToGltf, TheFirstFailureEndsItWithTheToolsOwnMessage) {
  const Outcome missing = demo("nothing.bvh");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("[file-missing]"));
  EXPECT_THAT(missing.out, Not(HasSubstr("Done")));

  std::ofstream(folder_ / "still.bvh")
      << "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition "
         "Zrotation "
         "Xrotation Yrotation\nJOINT Spine\n{\nOFFSET 0 20 0\nCHANNELS 3 Zrotation Xrotation "
         "Yrotation\nEnd Site\n{\nOFFSET 0 30 0\n}\n}\n}\nMOTION\nFrames: 0\nFrame Time: "
         "0.0333333\n";
  const Outcome still = demo("still.bvh");
  EXPECT_EQ(still.exit_code, 2);
  EXPECT_THAT(still.err, HasSubstr("no frames"));
  EXPECT_THAT(still.out, Not(HasSubstr("Done")));
}

TEST_F(WalkToGltf, ToolsThatAreNotThereAreNamed) {
  const Outcome run = shell("KROK_BIN=/nowhere '" KROK_SOURCE_DIR "/samples/walk_to_gltf/run.sh'");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("no krok-import in /nowhere"));
  EXPECT_THAT(run.err, HasSubstr("hint:"));
}

}  // namespace
}  // namespace krok
