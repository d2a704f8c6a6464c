// If these fail, the story of golden files no longer holds: a changed build passes, an equal one
// fails, or samples/mesh_regression/README.md has numbers that its script does not print.

#include <gmock/gmock.h>

#include "cli/story_test.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

class MeshRegression : public test::StoryTest {
 protected:
  MeshRegression() : StoryTest("mesh_regression") {}
};

TEST_F(MeshRegression, HoldsWhatItsReadmeTells) {
  const test::ToolRun run = story("'a folder'");
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const fs::path out = folder_ / "a folder";
  const std::string changed = get((out / "changed.txt").string());
  EXPECT_THAT(changed, StartsWith("differs: turn.glb: positions "));
  EXPECT_THAT(changed, HasSubstr("  the same      2\n")) << "the walk and the body did not change";
  std::string indented = "    " + changed;
  for (std::size_t at = 0; (at = indented.find('\n', at)) + 1 < indented.size();) {
    indented.insert(at + 1, "    ");
    at += 5;
  }
  EXPECT_THAT(told("README.md"), HasSubstr(indented));
  EXPECT_THAT(get((out / "changed.html").string()), HasSubstr("<code>turn.glb</code>"));
  EXPECT_THAT(run.out, HasSubstr("  replaced golden/turn.glb\n"));
  EXPECT_EQ(get((out / "golden/turn.glb").string()), get((out / "out/turn.glb").string()));

  EXPECT_THAT(get((out / "turn_heat.glb").string()), HasSubstr("COLOR_0"));
  EXPECT_EQ(get((out / "turn.svg").string()), told("pictures/turn.svg"));
  EXPECT_THAT(get((out / "turn.png").string()), StartsWith("\x89PNG"));
}

TEST_F(MeshRegression, ToolsThatAreNotThereAreNamed) {
  expect_missing_tools_told("krok-import");
}

}  // namespace
}  // namespace krok::test
