// What three.js, the Khronos validator and Blender read of a file with several clips. Would fail if
// a game artist found other names, or a clip that moves otherwise than its motion.
#include <filesystem>
#include <utility>

#include "cli/judged_test.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class ClipsByOthers : public JudgedTest {
 protected:
  // hero.glb with the clips walk and other, and walk.csv and other.csv with where joints are.
  void write_clips(const std::string& as) {
    put("walk.bvh", capture(41));
    put("other.bvh", capture(25, "0.2"));
    for (const std::string name : {"walk", "other"}) {
      ASSERT_EQ(run_here("krok-import", {name + ".bvh", "-o", name + ".anim", "-q"}).exit_code, 0);
      ASSERT_EQ(run_here("krok-export", {name + ".anim", "-o", name + ".csv", "-q"}).exit_code, 0);
    }
    ASSERT_EQ(
        run_here("krok-body", {"walk.anim", "--detail", "low", "-o", "hero.model", "-q"}).exit_code,
        0);
    ASSERT_EQ(run_here("krok-skin", {"hero.model", "walk.anim", "other.anim", "--as", as, "-o",
                                     "hero.glb", "-q"})
                  .exit_code,
              0);
  }
};

TEST_F(ClipsByOthers, ThreePlaysThemByName) {
  for (const std::string as : {"rig", "motion"}) {
    write_clips(as);
    judge({"validate_gltf.mjs", "hero.glb"});
    judge({"three_clips.mjs", "hero.glb", "walk=walk.csv", "other=other.csv"});
  }
}

// Would fail with inverse bind matrices that Blender cannot invert, as those of quantized files
// were.
TEST_F(ClipsByOthers, BlenderImportsThemByName) {
  constexpr const char* kBlender = "/usr/bin/blender";
  if (!std::filesystem::exists(kBlender)) GTEST_SKIP() << "blender is not installed";
  write_clips("rig");
  ASSERT_EQ(run_here("krok-skin", {"hero.model", "walk.anim", "other.anim", "--quantize", "-o",
                                   "small.glb", "-q"})
                .exit_code,
            0);
  for (const auto& [file, tolerance] : {std::pair("hero.glb", "0.01"), {"small.glb", "0.2"}}) {
    // Blender takes the modules of the first python3 in PATH, which need not be Debian's.
    const ToolRun run =
        test::run({"/usr/bin/env", "PATH=/usr/bin:/bin", kBlender, "-b", "--factory-startup",
                   "--python-exit-code", "3", "--python",
                   test::source_folder() + "/tests/golden/blender_clips.py", "--", path(file),
                   tolerance, "walk=" + path("walk.csv"), "other=" + path("other.csv")});
    EXPECT_EQ(run.exit_code, 0) << file << "\n" << run.out << run.err;
    EXPECT_THAT(run.out, HasSubstr("OK"));
  }
}

}  // namespace
}  // namespace krok::test
