// What Blender reads of krok-skin's clips, where it is installed. Would fail if a game artist found
// other names, or a clip that moves otherwise than its motion.
#include <filesystem>

#include "cli/motion_fixture.h"

namespace krok::test {
namespace {

class BlenderReads : public MotionTest {};

TEST_F(BlenderReads, TheClipsOfARigByNameAndAsTheyMove) {
  constexpr const char* kBlender = "/usr/bin/blender";
  if (!std::filesystem::exists(kBlender)) GTEST_SKIP() << "blender is not installed";
  write_walk(2);
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--mirror", "-o", "other.anim"}).exit_code, 0);
  ASSERT_EQ(run_here("krok-body", {"walk.anim", "--detail", "low", "-o", "body.model"}).exit_code,
            0);
  for (const std::string as : {"rig", "motion"}) {
    ASSERT_EQ(run_here("krok-skin",
                       {"body.model", "walk.anim", "other.anim", "--as", as, "-o", "hero.glb"})
                  .exit_code,
              0);
    std::vector<std::string> command = {kBlender,
                                        "-b",
                                        "--factory-startup",
                                        "--python-exit-code",
                                        "3",
                                        "--python",
                                        KROK_SOURCE_DIR "/tests/golden/blender_clips.py",
                                        "--",
                                        path("hero.glb")};
    for (const std::string clip : {"walk", "other"}) {
      ASSERT_EQ(run_here("krok-export", {clip + ".anim", "-o", clip + ".csv"}).exit_code, 0);
      command.push_back(clip + "=" + path(clip + ".csv"));
    }
    const ToolRun run = test::run(command);
    EXPECT_EQ(run.exit_code, 0) << as << run.out << run.err;
    EXPECT_THAT(run.out, HasSubstr("OK")) << as;
  }
}

}  // namespace
}  // namespace krok::test
