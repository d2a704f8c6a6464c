// If these fail, the story of the fall no longer holds: its script does not run, the walker does
// not get up and walk on, or jumps where the parts meet.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/story_test.h"
#include "core/file.h"
#include "core/index.h"
#include "formats/anim/anim.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class FallStory : public StoryTest {
 protected:
  FallStory() : StoryTest("fall") {}

  static Clip clip_of(const fs::path& path) {
    const auto file = InputFile::open(path.string());
    EXPECT_TRUE(file.ok()) << path;
    auto clip = anim::read(file->bytes());
    EXPECT_TRUE(clip.ok()) << path;
    return *std::move(clip);
  }
  static Vec3 hips_of(const Clip& clip, int frame) {
    return clip.frame_positions(frame)[at(clip.skeleton.find("Hips"))].cast<double>();
  }
};

TEST_F(FallStory, HoldsWhatItsReadmeTells) {
  const ToolRun made = story("'a folder'");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const fs::path out = folder_ / "a folder";
  for (const char* name : {"up.anim", "walker.ragdoll.json", "fall.anim", "fall.glb", "fall.html",
                           "fall.png", "stairs.anim", "stairs.png", "limits.svg", "laid.png",
                           "falls/left.anim", "falls/foot.anim"}) {
    EXPECT_TRUE(fs::exists(out / name)) << name;
  }
  const json up = json::parse(get(out / "up.json"));
  const json& rises = up["result"]["get_up"];
  EXPECT_TRUE(up["issues"].empty()) << up["issues"].dump();
  EXPECT_LT(rises["penetration"].get<double>(), 0.01);
  EXPECT_LT(rises["acceleration"].get<double>(), 1.5 * rises["motion_acceleration"].get<double>());
  EXPECT_EQ(json::parse(get(out / "falls.json"))["result"]["falls"].size(), 6U);

  const json laid = json::parse(get(out / "laid.json"));
  EXPECT_TRUE(laid["issues"].empty()) << laid["issues"].dump();
  const json& settled = laid["result"]["steps"].back();
  EXPECT_GT(settled["before"]["depth"].get<double>() + settled["before"]["hover"].get<double>(),
            0.05);
  EXPECT_LT(settled["after"]["depth"].get<double>(), 0.005);
  EXPECT_LT(settled["after"]["hover"].get<double>(), 0.005);
  EXPECT_LT(settled["jerk"].get<double>(), 1.5);

  const json stairs = json::parse(get(out / "stairs.json"))["result"];
  EXPECT_LT(stairs["largest"]["penetration"].get<double>(), 0.005);
  EXPECT_GT(stairs["rest_time"].get<double>(), 0);
  EXPECT_LT(stairs["get_up"]["penetration"].get<double>(), 0.015);

  // Walks on at the foot of the stairs, 2.04 m down.
  const Clip on = clip_of(out / "stairs.anim");
  EXPECT_NEAR(hips_of(on, on.frame_count() - 1).y(), -2.04 + 0.95, 0.1);
  const int stands = clip_of(out / "stairs_up.anim").frame_count();
  EXPECT_GT((hips_of(on, on.frame_count() - 1) - hips_of(on, stands)).norm(), 1.0);

  const Clip clip = clip_of(out / "fall.anim");
  const auto hips = [&](int frame) { return hips_of(clip, frame); };
  const int last = clip.frame_count() - 1, lies = rises["first_frame"].get<int>();
  EXPECT_LT(hips(lies).y(), 0.4);
  EXPECT_GT(hips(last).y(), 0.8);
  EXPECT_GT((hips(last) - hips(lies)).norm(), 1.0);
  // From lying on, the hips move at a person's speed: nothing jumps.
  for (int f = lies; f < last; ++f) {
    EXPECT_LT((hips(f + 1) - hips(f)).norm() * clip.rate, 2.5) << f;
  }
}

}  // namespace
}  // namespace krok::test
