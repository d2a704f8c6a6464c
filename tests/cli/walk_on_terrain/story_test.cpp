// If these fail, the story of walks on terrain no longer holds: its script does not run, or feet
// miss their prints.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/story_test.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class WalkOnTerrain : public StoryTest {
 protected:
  WalkOnTerrain() : StoryTest("walk_on_terrain") {}
};

TEST_F(WalkOnTerrain, HoldsWhatItsReadmeTells) {
  const ToolRun made = story("'a folder'");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const fs::path out = folder_ / "a folder";
  for (const char* name :
       {"hill.anim", "hill.keys.json", "prints.csv", "hill.glb", "hill.html", "hill.png",
        "hill.svg", "stairs.anim", "stairs.html", "stairs.png", "stones.anim", "stones.html",
        "stones.png", "child.anim", "child.keys.json", "child.html"}) {
    EXPECT_TRUE(fs::exists(out / name)) << name;
  }
  for (const char* walk : {"hill", "stairs", "stones"}) {
    const json report = json::parse(get(out / (std::string(walk) + ".json")));
    const json& steps = report["result"]["steps"];
    EXPECT_GE(steps.size(), 8U) << walk;
    EXPECT_TRUE(report["issues"].empty()) << walk << report["issues"].dump();
    for (const json& step : steps) EXPECT_LT(step["missed"].get<double>(), 1e-4) << walk;
  }
  // The child stands on the same stairs.
  const json child = json::parse(get(out / "child.json"))["result"]["ground"];
  EXPECT_LT(child["drift"], 1e-3);
  EXPECT_LT(child["off_ground"], 1e-3);
  EXPECT_EQ(child["frames_out_of_reach"], 0);
  const std::string readme = told("README.md");
  const auto at = made.err.find("hill.anim: ");
  ASSERT_NE(at, std::string::npos);
  EXPECT_NE(readme.find(made.err.substr(at, made.err.find('\n', at) - at)), std::string::npos)
      << "the page shows another line than the tool prints";
  // The prints that were planned are walked again when they are given back.
  const fs::path again = out / "again.anim";
  const ToolRun walked =
      run({test::tools_folder() + "/krok-walk", "-q", (out / "walking.steps").string(), "--prints",
           (out / "prints.csv").string(), "--ground", (out / "hill.obj").string(), "-o",
           again.string()});
  EXPECT_EQ(walked.exit_code, 0) << walked.err;
  EXPECT_EQ(run({test::tools_folder() + "/krok-diff", "-q", (out / "hill.anim").string(),
                 again.string(), "--tolerance", "0.1mm"})
                .exit_code,
            0);
}

}  // namespace
}  // namespace krok::test
