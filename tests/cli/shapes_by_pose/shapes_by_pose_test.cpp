// If this fails, correctives miss the sculpt or the volume by more than they may, or
// samples/shapes_by_pose/README.md has numbers that its script does not print.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/story_test.h"

namespace krok::test {
namespace {

class ShapesByPose : public test::StoryTest {
 protected:
  ShapesByPose() : StoryTest("shapes_by_pose") {}
};

TEST_F(ShapesByPose, HoldsWhatItsReadmeTells) {
  const test::ToolRun run = story("'a folder'");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::filesystem::path out = folder_ / "a folder";
  EXPECT_THAT(told("README.md"), testing::HasSubstr(get(out / "volume.md")));
  const auto report = nlohmann::json::parse(get(out / "fit.json"));
  ASSERT_EQ(report["result"]["joints"].size(), 4u);
  for (const auto& joint : report["result"]["joints"]) {
    EXPECT_EQ(joint["targets"], 5);
    EXPECT_EQ(joint["held_out"]["poses"], 20);
    EXPECT_LT(joint["held_out"]["share"].get<double>(), 0.1) << joint["joint"];
  }
}

}  // namespace
}  // namespace krok::test
