// If these fail, the story of the speaking face no longer holds: its script does not run, lips are
// open at b, m and p, or eyes miss what they look at.

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/story_test.h"
#include "formats/textgrid/textgrid.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class Talk : public StoryTest {
 protected:
  Talk() : StoryTest("talk") {}
};

TEST_F(Talk, LipsCloseAndEyesReachWhatTheyLookAt) {
  const ToolRun made = story("'a folder'");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const fs::path out = folder_ / "a folder";
  std::istringstream table(get(out / "talk.weights.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "frame,time,jaw,wide,round,press,bite,smile,blink");
  std::vector<double> press;
  double blinks = 0;
  while (std::getline(table, line)) {
    std::vector<double> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    ASSERT_EQ(row.size(), 9u);
    press.push_back(row[5]);
    blinks = std::max(blinks, row[8]);
  }
  ASSERT_EQ(press.size(), 211u);
  EXPECT_GT(blinks, 0.9);
  int closures = 0;
  const auto phones = textgrid::read_intervals(told("talk.TextGrid"), "talk.TextGrid", "");
  ASSERT_TRUE(phones.ok());
  for (const textgrid::Interval& phone : *phones) {
    if (phone.label != "P" && phone.label != "B" && phone.label != "M") continue;
    ++closures;
    const double frame = std::round(15 * (phone.start + phone.end));
    EXPECT_NEAR(press[static_cast<std::size_t>(frame)], 1, 1e-6) << phone.start;
  }
  EXPECT_EQ(closures, 11);
  const json result = json::parse(get(out / "talk.report.json"))["result"];
  ASSERT_EQ(result["gaze"].size(), 3u);
  for (const json& shift : result["gaze"]) EXPECT_LT(shift["missed"], 2);
}

TEST_F(Talk, TellsWhatIsMissing) {
  expect_missing_tools_told("krok-import");
}

}  // namespace
}  // namespace krok::test
