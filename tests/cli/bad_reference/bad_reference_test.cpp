// If this fails, a bad reference pose goes unnoticed, or samples/bad_reference/README.md has
// numbers that its script does not print.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "cli/story_test.h"

namespace krok::test {
namespace {

class BadReference : public test::StoryTest {
 protected:
  BadReference() : StoryTest("bad_reference") {}
};

TEST_F(BadReference, HoldsWhatItsReadmeTells) {
  const test::ToolRun run = story("'a folder'");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(told("README.md"), testing::HasSubstr(get(folder_ / "a folder" / "reference.md")));
  EXPECT_TRUE(has_code(run.err, "skin-reference-pose")) << run.err;
}

}  // namespace
}  // namespace krok::test
