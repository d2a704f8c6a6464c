// If these fail, the story of captured steps no longer holds: its script does not run, steps of two
// directions mix, or a walk of steps backward goes forward.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/story_test.h"
#include "core/file.h"
#include "core/index.h"
#include "formats/anim/anim.h"
#include "motion/hips_root.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class CapturedSteps : public StoryTest {
 protected:
  CapturedSteps() : StoryTest("captured_steps") {}

  // How far the hips went in the direction that the character faces at the end, metres.
  static double way_ahead(const fs::path& path) {
    const auto file = InputFile::open(path.string());
    EXPECT_TRUE(file.ok()) << path;
    const auto clip = anim::read(file->bytes());
    EXPECT_TRUE(clip.ok()) << path;
    const int hips = carrying_joint(find_roles(clip->skeleton));
    const GroundFrame from = ground_frame(*clip, hips, 0);
    const GroundFrame to = ground_frame(*clip, hips, clip->frame_count() - 1);
    return (to.x - from.x) * std::sin(to.heading) + (to.z - from.z) * std::cos(to.heading);
  }
};

TEST_F(CapturedSteps, HoldsWhatItsReadmeSays) {
  const ToolRun made = story("'' 'a folder'");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const fs::path out = folder_ / "a folder";
  for (const char* name : {"walk.png", "walk_back.png", "charts/errors.svg"}) {
    EXPECT_TRUE(fs::exists(out / name)) << name;
  }
  const json forward = json::parse(get(out / "forward_fit.json"))["result"];
  const json backward = json::parse(get(out / "backward_fit.json"))["result"];
  EXPECT_GT(forward["examples"].size(), 60U);
  EXPECT_GE(backward["examples"].size(), 8U);
  EXPECT_GT(forward["parameters"][0]["from"].get<double>(), 0.4);
  EXPECT_LT(backward["parameters"][0]["to"].get<double>(), -0.3);
  EXPECT_NEAR(way_ahead(out / "walk.anim"), 4, 0.1);
  EXPECT_NEAR(way_ahead(out / "walk_back.anim"), -3, 0.1);
  // The same on a folder of captures.
  const ToolRun again = story("'a folder/captures' other");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(get(folder_ / "other/forward.steps").size(), get(out / "forward.steps").size());
}

TEST_F(CapturedSteps, NamesWhatIsMissing) {
  expect_missing_tools_told("krok-keys");
}

}  // namespace
}  // namespace krok::test
