// If these fail, two joints get one name, and what goes by names mixes them up.

#include "capture/unique_names.h"

#include <gtest/gtest.h>

namespace krok {
namespace {

TEST(UniqueNames, TheNextFreeNumberIsTaken) {
  UniqueNames names;
  EXPECT_EQ(names.make("a"), "a");
  EXPECT_EQ(names.make("a"), "a_2");
  EXPECT_TRUE(names.claim("a_3"));
  EXPECT_FALSE(names.claim("a_3"));
  EXPECT_EQ(names.make("a"), "a_4");
  EXPECT_EQ(names.make("a_2"), "a_2_2");
}

}  // namespace
}  // namespace krok
