// If this fails, the story of the timeline no longer holds: its script does not run, motions are
// not brought into step, a change jerks, or feet slide where the motions go over into one another.

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/story_test.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class TimelineStory : public StoryTest {
 protected:
  TimelineStory() : StoryTest("timeline") {}
};

TEST_F(TimelineStory, HoldsWhatItsReadmeTells) {
  const ToolRun made = story("'a folder'");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, Not(HasSubstr("mix-pop")));
  const fs::path out = folder_ / "a folder";
  for (const char* file : {"story.anim", "story.keys.json", "story.cam", "story.glb", "story.html",
                           "story.png", "moments.png"}) {
    EXPECT_TRUE(fs::exists(out / file)) << file;
  }

  const json result = json::parse(get(out / "story.report.json"))["result"];
  std::vector<std::string> kinds;
  for (const json& change : result["changes"]) {
    kinds.push_back(change["kind"]);
    EXPECT_FALSE(change["pops"].get<bool>()) << change;
    if (kinds.back() == "crossfade") {
      EXPECT_TRUE(change["in_step"].get<bool>()) << change;
    }
  }
  EXPECT_THAT(
      kinds, ElementsAre("crossfade", "crossfade", "crossfade", "crossfade", "smooth", "inertial"));

  // The limp begins when the left foot strikes, within three hundredths of a second.
  double begins = -1;
  for (const json& item : result["items"]) {
    if (item["name"] == "limp") begins = item["start"];
  }
  double nearest = 1;
  const json sidecar = json::parse(get(out / "story.keys.json"));
  for (const json& key : sidecar["keytimes"]) {
    if (key["name"] != "left_strike") continue;
    nearest = std::min(nearest, std::abs(key["time"].get<double>() - begins));
  }
  EXPECT_LT(nearest, 0.03);

  // Nothing slides far: the motions themselves do not, by the clock it would be 0.3 m/s.
  const ToolRun keys =
      run_tool("krok-keys", {(out / "story.anim").string(), "--discard-edits", "--json"});
  ASSERT_EQ(keys.exit_code, 0) << keys.err;
  const json found = json::parse(keys.out)["result"];
  EXPECT_LT(found["gait"]["slide_speed"].get<double>(), 0.02);
}

}  // namespace
}  // namespace krok::test
