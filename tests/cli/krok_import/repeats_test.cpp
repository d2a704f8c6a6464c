// If these fail, a take that was exported at a multiple of its rate, each pose four times, is
// imported without a word.

#include <gmock/gmock.h>

#include <fstream>

#include "cli/krok_import/imported.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// The sample's walk with each of its frames so many times.
std::string walk_with(int times) {
  std::ifstream walk(source_folder() + "/samples/captures/walk.bvh");
  std::string text, line;
  int frames = -1;
  while (std::getline(walk, line)) {
    if (line.starts_with("Frames:")) line = "Frames: " + std::to_string(264 * times);
    for (int i = 0; i < (frames >= 0 ? times : 1); ++i) text += line + "\n";
    if (frames >= 0 || line.starts_with("Frame Time")) ++frames;
  }
  return text;
}

using RepeatsTest = CliTest;

TEST_F(RepeatsTest, FramesThatRepeatInFoursAreWarnedOf) {
  const auto import = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {path(name), "-o", path("out.anim")});
    const ToolRun run = run_tool("krok-import", more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.err;
  };
  put("once.bvh", walk_with(1));
  put("four.bvh", walk_with(4));
  EXPECT_THAT(import("once.bvh", {}), Not(HasSubstr("import-repeats")));
  const std::string four = import("four.bvh", {});
  EXPECT_THAT(four, HasSubstr("each pose is there 4 times in turn: 15 frames per second of 60"));
  EXPECT_THAT(four, HasSubstr("[import-repeats]"));
  EXPECT_THAT(import("four.bvh", {"--rate", "15"}), Not(HasSubstr("import-repeats")));
}

}  // namespace
}  // namespace krok::test
