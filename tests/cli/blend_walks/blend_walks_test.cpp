// If these fail, the blending story no longer holds: motions blended by keytimes slide about as
// much as those blended by the clock, feet strike elsewhere than at the weighted keytimes, or
// samples/blend_walks/README.md has numbers that its script does not print.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>
#include <vector>

#include "cli/story_test.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class BlendWalks : public test::StoryTest {
 protected:
  BlendWalks() : StoryTest("blend_walks") {}

  // The rows of a Markdown table without its head.
  static std::vector<std::vector<std::string>> rows_of(const std::string& table) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(table);
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> cells;
      std::istringstream row(line);
      for (std::string cell; std::getline(row, cell, '|');) cells.push_back(cell);
      rows.push_back(std::move(cells));
    }
    rows.erase(rows.begin(), rows.begin() + std::min<std::ptrdiff_t>(2, std::ssize(rows)));
    return rows;
  }
};

TEST_F(BlendWalks, HoldsWhatItsReadmeTells) {
  const test::ToolRun run = story("'a folder'");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const fs::path out = folder_ / "a folder";
  const std::string readme = told("README.md");

  const std::string slide = get(out / "slide.md"), strikes = get(out / "strikes.md");
  EXPECT_THAT(readme, HasSubstr(slide));
  EXPECT_THAT(readme, HasSubstr(strikes));

  // In step, in step with feet kept in place, by the clock.
  const auto speeds = rows_of(slide);
  ASSERT_EQ(speeds.size(), 3U);
  const double warped = std::stod(speeds[0].at(2)), stance = std::stod(speeds[1].at(2)),
               clock = std::stod(speeds[2].at(2));
  EXPECT_GE(clock, 2 * warped);
  EXPECT_LT(stance, warped);

  const auto keytimes = rows_of(strikes);
  ASSERT_EQ(keytimes.size(), 6U);
  for (const auto& row : keytimes) {
    const double slow = std::stod(row.at(2)), quick = std::stod(row.at(3));
    EXPECT_NEAR(std::stod(row.at(4)), 0.5 * (slow + quick), 0.001) << row.at(1);
    EXPECT_NEAR(std::stod(row.at(5)), 0.5 * (slow + quick), 1.0 / 60) << row.at(1);
  }

  EXPECT_THAT(get(out / "slide.svg"), HasSubstr("by the clock"));
  EXPECT_EQ(get(out / "slide.svg"), told("pictures/slide.svg"));
  EXPECT_THAT(get(out / "sweep.png"), StartsWith("\x89PNG"));
  EXPECT_GT(fs::file_size(out / "sweep.png"), 10000U);
}

TEST_F(BlendWalks, ToolsThatAreNotThereAreNamed) {
  expect_missing_tools_told("krok-import");
}

}  // namespace
}  // namespace krok::test
