// If these fail, the story of the rail no longer holds: its script does not run, feet slide on, the
// hand does not stay on the rail, or samples/reach_and_plant/README.md tells figures that its
// script does not print.

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/story_test.h"
#include "core/file.h"
#include "core/index.h"
#include "formats/anim/anim.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class ReachAndPlant : public StoryTest {
 protected:
  ReachAndPlant() : StoryTest("reach_and_plant") {}

  Clip clip_of(const fs::path& path) const {
    const auto file = InputFile::open(path.string());
    EXPECT_TRUE(file.ok()) << path;
    return anim::read(file->bytes()).value();
  }
};

TEST_F(ReachAndPlant, HoldsWhatItsReadmeTells) {
  const ToolRun made = story("'a folder'");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const fs::path out = folder_ / "a folder";
  const std::string readme = told("README.md");

  const json planted = json::parse(get(out / "standing.report.json"))["result"]["plant"];
  EXPECT_GT(planted["drift_before"], 0.02);
  EXPECT_LT(planted["drift"], 0.0005);
  EXPECT_EQ(planted["frames_out_of_reach"], 0);

  const json result = json::parse(get(out / "rail.report.json"))["result"];
  EXPECT_LT(result["plant"]["drift"], 0.0005);
  EXPECT_LE(result["limits"]["largest_excess"].get<double>(), 1e-6);
  const json& rail = result["goals"][0];
  EXPECT_EQ(rail["reached_frames"], rail["full_strength_frames"]);

  // What the tools say is what the page shows.
  for (const char* start : {"standing.anim: feet planted", "rail.anim: 3 goals"}) {
    const auto at = made.err.find(start);
    ASSERT_NE(at, std::string::npos) << made.err;
    EXPECT_THAT(readme, HasSubstr(made.err.substr(at, made.err.find('\n', at) - at)));
  }

  // The hand is on the rail and moves evenly along it; the legs are those of the planted walk.
  const Clip walk = clip_of(out / "standing.anim"), clip = clip_of(out / "rail.anim");
  const auto hand = at(clip.skeleton.find("RightHand"));
  for (int f = 60; f <= 150; ++f) {
    const Vec3f place = clip.frame_positions(f)[hand];
    EXPECT_NEAR(place.x(), -0.42, 5e-4) << f;
    EXPECT_NEAR(place.y(), 0.95, 5e-4) << f;
    EXPECT_NEAR(place.z(), 1.0 + 1.65 * (f - 60) / 90, 5e-4) << f;
  }
  for (const char* joint : {"Hips", "LeftFoot", "RightFoot"}) {
    const auto j = at(clip.skeleton.find(joint));
    for (int f = 0; f < clip.frame_count(); ++f) {
      EXPECT_EQ(clip.frame_positions(f)[j], walk.frame_positions(f)[j]) << joint << f;
    }
  }
  EXPECT_EQ(get(out / "rail.svg"), told("pictures/rail.svg"));
  EXPECT_EQ(get(out / "stance.svg"), told("pictures/stance.svg"));
  for (const char* image : {"moments.png", "strip.png"}) {
    EXPECT_THAT(get(out / image), StartsWith("\x89PNG"));
  }
  EXPECT_THAT(get(out / "rail.html"), HasSubstr("\"name\":\"glance\""));
}

TEST_F(ReachAndPlant, ToolsThatAreNotThereAreNamed) {
  expect_missing_tools_told("krok-ik");
}

}  // namespace
}  // namespace krok::test
