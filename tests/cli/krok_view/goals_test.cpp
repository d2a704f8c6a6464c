// If these fail, krok-view leaves out the goals of a krok-ik file, has them at another place or
// with another residual, or shows goals that the motion cannot have.

#include <gmock/gmock.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "cli/kept_files.h"
#include "math/transform.h"
#include "shown_page.h"

namespace krok::test {
namespace {

class KrokViewGoals : public CliTest {
 protected:
  KrokViewGoals() {
    put("goals.json", R"({"schema": "krok.goals/1", "goals": [
  {"name": "rail", "joint": "RightHand", "depth": 3,
   "keys": [{"time": 1, "target": [-0.4, 1.1, 0.9]}, {"time": 2, "target": [-0.4, 1.1, 1.9]}]},
  {"kind": "orientation", "joint": "Head", "keys": [{"time": 3, "orientation": [0, 0, 0, 1]}]},
  {"kind": "pole", "joint": "RightForeArm", "keys": [{"time": 1, "target": [-1.5, 0.8, 0]}]},
  {"kind": "balance"}]})");
  }

  ToolRun view(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--body", "none", "-o", path("page.html")});
    return run_tool("krok-view", arguments);
  }
  std::string goals() const { return path("goals.json"); }

  // The nine numbers of a frame: from, to, strength, distance, angle.
  std::vector<float> numbers(const json& goal, std::size_t item, int frame) const {
    const std::string bytes =
        bytes_of_base64(element_of(get(path("page.html")), "krok-blob-" + std::to_string(item)));
    std::vector<float> values(9);
    const auto at =
        goal["frames"]["offset"].get<std::size_t>() + 36 * static_cast<std::size_t>(frame);
    std::memcpy(values.data(), bytes.data() + at, 36);
    return values;
  }
};

TEST_F(KrokViewGoals, HaveTheResidualsOfTheReport) {
  const ToolRun ik = run_tool("krok-ik", {kWalk, "--goals", goals(), "-o", path("reach.anim"),
                                          "--orientation", "xyzw", "--json"});
  ASSERT_EQ(ik.exit_code, 0) << ik.err;
  const ToolRun made = view({path("reach.anim"), kWalk, "--goals", goals(), "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(json::parse(made.out)["result"]["motions"][1]["goals"], 4);
  const json items = data_of(get(path("page.html")))["items"];
  ASSERT_EQ(items.size(), 2U);
  const json reported = json::parse(ik.out)["result"]["goals"];
  for (std::size_t g = 0; g < 4; ++g) {
    const json& shown = items[0]["goals"][g];
    EXPECT_EQ(shown["name"], reported[g]["name"]);
    EXPECT_EQ(shown["kind"], reported[g]["kind"]);
    EXPECT_EQ(shown["frames"]["count"], 9 * 264);
    for (const json& frame : reported[g]["frames"]) {
      const auto now = numbers(shown, 0, frame["frame"]);
      EXPECT_FLOAT_EQ(now[6], frame["strength"].get<float>());
      // While it fades a goal asks for less than what is shown; balance is over the feet of the
      // motion that went in.
      if (frame["strength"] < 1 || shown["kind"] == "balance") continue;
      EXPECT_NEAR(now[7], frame["distance"].get<double>(), 1e-5) << g;
      EXPECT_NEAR(now[8], frame["angle"].get<double>() * kRadiansPerDegree, 1e-5) << g;
    }
  }
  const auto hand = numbers(items[0]["goals"][0], 0, 90);
  EXPECT_FLOAT_EQ(hand[3], -0.4F);
  EXPECT_NEAR(hand[5], 1.4, 1e-6);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(hand[axis], hand[axis + 3], 1e-4);
  EXPECT_EQ(items[0]["goals"][0]["chain"].size(), 3U);
  EXPECT_EQ(items[0]["goals"][3]["chain"].size(), 0U);
  // The walk as it was misses the same goal.
  EXPECT_GT(numbers(items[1]["goals"][0], 1, 90)[7], 0.05F);
  // Before the goal begins there is none.
  EXPECT_EQ(numbers(items[0]["goals"][0], 0, 0)[6], 0.0F);
}

TEST_F(KrokViewGoals, SayWhatIsWrongWithThem) {
  const auto refused = [&](const std::vector<std::string>& arguments, const char* says) {
    const ToolRun run = view(arguments);
    EXPECT_EQ(run.exit_code, 2) << says;
    EXPECT_THAT(run.err, HasSubstr(says));
    EXPECT_FALSE(std::filesystem::exists(path("page.html")));
  };
  refused({kFrozen + "camera.cam", "--goals", goals()}, "--goals needs a motion");
  refused({kWalk, "--goals", path("none.json")}, "file-missing");
  put("bad.json", R"({"schema": "krok.goals/1", "goals": [
  {"joint": "RightHnd", "keys": [{"time": 0, "target": [0, 0, 0]}]}]})");
  refused({kWalk, "--goals", path("bad.json")}, "bad.json:2:13: error: ");
  put("pole.json", R"({"schema": "krok.goals/1", "goals": [
  {"kind": "pole", "joint": "Hips", "keys": [{"time": 0, "target": [0, 0, 0]}]}]})");
  refused({kWalk, "--goals", path("pole.json")}, "[ik-goal]");
}

}  // namespace
}  // namespace krok::test
