// If these fail, the story of reaches and kicks no longer holds: the hand of the reach library
// misses by more than a millimetre or refinement gains less than a factor of 20, or what follows a
// walk does not begin where it ends, or misses its place in the world.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/story_test.h"
#include "core/file.h"
#include "core/index.h"
#include "formats/anim/anim.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class ReachAndKick : public StoryTest {
 protected:
  ReachAndKick() : StoryTest("reach_and_kick") {}

  static void hand_errs_twenty_times_less(const fs::path& out);
  static void mistakes_are_told(const fs::path& out);

  Clip clip_of(const fs::path& path) const {
    const auto file = InputFile::open(path.string());
    EXPECT_TRUE(file.ok()) << path;
    return anim::read(file->bytes()).value();
  }
};

TEST_F(ReachAndKick, HoldsWhatItsReadmeTells) {
  const ToolRun made = story("'a folder'");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.err, Not(HasSubstr("warning"))) << made.err;
  const fs::path out = folder_ / "a folder";
  const std::string readme = told("README.md");
  // The lines of the tables' figures.
  for (const char* start : {"  across, ", "  up, ", "  along, ", "  side, ", "  height, "}) {
    const auto at = made.err.rfind(start);
    ASSERT_NE(at, std::string::npos) << made.err;
    // What refinement leaves differs between compilers by a few hundredths.
    const std::string line = made.err.substr(at, made.err.find('\n', at) - at);
    const std::string before = line.substr(0, line.find("before, ") + 8);
    const auto same = readme.find(before);
    ASSERT_NE(same, std::string::npos) << line;
    EXPECT_NEAR(
        std::stod(line.substr(before.size())) / std::stod(readme.substr(same + before.size())), 1,
        0.1)
        << line;
  }

  // Where the wrist is at the touch, in the whole, by its frames alone.
  const json reach = json::parse(get(out / "reach.report.json"))["result"];
  EXPECT_LT(reach["sequence"]["missed"], 1e-4);
  const Clip clip = clip_of(out / "reach.anim");
  const auto hand = at(clip.skeleton.find("RightHand"));
  double nearest = 1;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Vec3f off = clip.frame_positions(f)[hand] - Vec3f(-0.25F, 1.15F, 3.45F);
    nearest = std::min(nearest, double(off.norm()));
  }
  EXPECT_LT(nearest, 0.002);

  // Nothing jumps: not where one motion follows the other, either.
  const Clip all = clip_of(out / "all.anim");
  EXPECT_NEAR(all.duration(), 4.833 + 1.9 + 1.5, 0.05);
  for (int f = 1; f < all.frame_count(); ++f) {
    for (const char* joint : {"Hips", "Head", "LeftFoot"}) {
      const auto j = at(all.skeleton.find(joint));
      EXPECT_LT((all.frame_positions(f)[j] - all.frame_positions(f - 1)[j]).norm(), 0.08F) << f;
    }
  }
  hand_errs_twenty_times_less(out);
  mistakes_are_told(out);
}

// The wrist's distance to 1,000 points asked for, as krok-synth measures the motions it makes.
void ReachAndKick::hand_errs_twenty_times_less(const fs::path& out) {
  std::string points = "across,up,along\n";
  std::uint64_t state = 5;
  const auto unit = [&] {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  for (int i = 0; i < 1000; ++i) {
    points += std::to_string(0.105 + 0.28 * unit()) + "," + std::to_string(0.975 + 0.26 * unit()) +
              "," + std::to_string(0.545 + 0.125 * unit()) + "\n";
  }
  fs::create_directory(out / "many");
  ASSERT_TRUE(write_file((out / "thousand.csv").string(), points).ok());
  double mean[2] = {0, 0}, largest[2] = {0, 0};
  for (const int refined : {0, 1}) {
    const ToolRun run =
        run_tool("krok-synth", {(out / (refined ? "reaches.steps" : "unrefined.steps")).string(),
                                "--points", (out / "thousand.csv").string(), "-o",
                                (out / "many" / "point.anim").string(), "--json", "-q"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json motions = json::parse(run.out)["result"]["motions"];
    ASSERT_EQ(motions.size(), 1000u);
    for (const json& motion : motions) {
      double square = 0;
      for (const char* name : {"across", "up", "along"}) {
        const double off =
            motion["asked"][name].get<double>() - motion["measured"][name].get<double>();
        square += off * off;
      }
      mean[refined] += std::sqrt(square) / 1000;
      largest[refined] = std::max(largest[refined], std::sqrt(square));
    }
  }
  EXPECT_LT(largest[1], 1e-3);
  EXPECT_LT(mean[1], mean[0] / 20) << mean[0] << " " << mean[1];
  EXPECT_LT(largest[1], largest[0] / 20) << largest[0] << " " << largest[1];
}

void ReachAndKick::mistakes_are_told(const fs::path& out) {
  const auto at_out = [&](const char* name) { return (out / name).string(); };
  const auto synth = [&](const char* library, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), at_out(library));
    arguments.insert(arguments.end(), {"-o", at_out("new.anim")});
    return run_tool("krok-synth", arguments);
  };
  const ToolRun far = synth("reaches.steps", {"--after", at_out("walk.bvh"), "--place", "0,1,9"});
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_THAT(far.err, HasSubstr("parametric-bounds"));
  const ToolRun plane = synth("kicks.steps", {"--after", at_out("walk.bvh"), "--place", "0,1,9"});
  EXPECT_EQ(plane.exit_code, 2);
  EXPECT_THAT(plane.err, HasSubstr("synth-place"));
  EXPECT_EQ(synth("kicks.steps", {"--place", "0,1,9"}).exit_code, 2);
  EXPECT_EQ(synth("kicks.steps", {"--in-sequence"}).exit_code, 2);
  EXPECT_FALSE(fs::exists(at_out("new.anim")));
}

}  // namespace
}  // namespace krok::test
