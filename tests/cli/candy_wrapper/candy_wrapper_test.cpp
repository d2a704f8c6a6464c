// If these fail, the story of the twisted forearm no longer holds: a method loses or keeps other
// parts of the volume than its formula says, or samples/candy_wrapper/README.md tells figures that
// its script does not print.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

#include "cli/story_test.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class CandyWrapper : public test::StoryTest {
 protected:
  CandyWrapper() : StoryTest("candy_wrapper") {}
};

TEST_F(CandyWrapper, HoldsWhatItsReadmeTells) {
  const test::ToolRun run = story("'a folder'");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const fs::path out = folder_ / "a folder";
  EXPECT_THAT(told("README.md"), HasSubstr(get(out / "volume.md")));

  // Percent of the volume between elbow and wrist, by method and degrees.
  std::map<std::string, std::map<int, double>> lost;
  std::istringstream table(get(out / "volume.csv"));
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    const auto first = line.find(','), second = line.find(',', first + 1);
    lost[line.substr(first + 1, second - first - 1)][std::stoi(line)] =
        std::stod(line.substr(second + 1));
  }
  ASSERT_EQ(lost.size(), 3U);
  for (const auto& [method, by_degrees] : lost) EXPECT_EQ(by_degrees.size(), 13U) << method;
  for (const auto& [degrees, percent] : lost["linear"]) {
    // Each section is scaled by 1 - 2 w (1 - w) (1 - cos twist), whatever its shape; w goes from 0
    // to 1 evenly.
    const double closed_form = 100 * (1 - std::cos(degrees * std::numbers::pi / 180)) / 3;
    EXPECT_NEAR(percent, closed_form, 0.06) << degrees;
  }
  // Sections are turned and keep their size.
  for (const auto& [degrees, percent] : lost["dual-quaternion"]) {
    EXPECT_NEAR(percent, 0, 0.06) << degrees;
  }
  // All of the twist is between two of the 121 sections: 1/120 of what linear blend would lose.
  for (const auto& [degrees, percent] : lost["rigid"]) {
    EXPECT_NEAR(percent, lost["linear"][degrees] / 120, 0.06) << degrees;
  }

  EXPECT_EQ(get(out / "volume.svg"), told("pictures/volume.svg"));
  EXPECT_THAT(get(out / "twist.png"), StartsWith("\x89PNG"));
  EXPECT_GT(fs::file_size(out / "twist.png"), 10000U);
}

TEST_F(CandyWrapper, ToolsThatAreNotThereAreNamed) {
  expect_missing_tools_told("krok-skin");
}

}  // namespace
}  // namespace krok::test
