// If this fails, the script of samples/from_positions does not run, the noise of its positions is
// not found or not smoothed, feet do not stand, or its page tells figures that the script does not
// print.

#include <gmock/gmock.h>

#include <cstdlib>

#include "cli/story_test.h"

namespace krok::test {
namespace {

class FromPositions : public StoryTest {
 protected:
  FromPositions() : StoryTest("from_positions") {}
};

TEST_F(FromPositions, HoldsWhatItsReadmeTells) {
  if (std::system("/usr/bin/python3 -c 'import numpy' 2> /dev/null") != 0) {
    GTEST_SKIP() << "no numpy";
  }
  const ToolRun made = story("out");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const std::string readme = told("README.md"), printed = made.out + made.err;
  for (const char* line :
       {"noise 5.06 mm, smoothed", "heels and balls drift by up to 0.000481 mm"}) {
    EXPECT_THAT(printed, testing::HasSubstr(line));
    EXPECT_THAT(readme, testing::HasSubstr(line));
  }
  EXPECT_EQ(get(folder_ / "out" / "foot.svg"), told("pictures/foot.svg"));
}

}  // namespace
}  // namespace krok::test
