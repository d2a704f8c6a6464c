// If these fail, the journal of a batch grows from run to run, depends on which thread was first,
// or leaves files of its own behind.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/folder_test.h"
#include "tools/batch/journal.h"

namespace krok::cli::batch {
namespace {

class JournalTest : public test::FolderTest {
 protected:
  // Two results, the second done first and then once more.
  void run() const {
    Journal journal(path(""), "krok-test", "");
    ASSERT_TRUE(journal.add({{"output", "b.anim"}, {"made_with", "1"}}));
    ASSERT_TRUE(journal.add({{"output", "a.anim"}, {"made_with", "1"}}));
    ASSERT_TRUE(journal.add({{"output", "b.anim"}, {"made_with", "2"}}));
    ASSERT_TRUE(journal.tidy());
  }
  const std::string name_ = "krok-test.journal.jsonl";
  const std::string tidy_ =
      "{\"output\":\"a.anim\",\"made_with\":\"1\"}\n{\"output\":\"b.anim\",\"made_with\":\"2\"}\n";
};

TEST_F(JournalTest, TidyItHasTheNewestLineForEachOutputInOrder) {
  for (int i = 0; i < 2; ++i) {
    run();
    EXPECT_EQ(get(path(name_)), tidy_);
    EXPECT_EQ(listing(), std::vector<std::string>{name_});
  }
}

TEST_F(JournalTest, WhatAKilledRunLeftWhileTidyingIsNoTrouble) {
  std::ofstream(path(name_ + ".new")) << "{\"output\":\"c.anim\",\"made_with\":\"0\"}\n";
  run();
  EXPECT_EQ(get(path(name_)), tidy_);
  EXPECT_EQ(listing(), std::vector<std::string>{name_});
}

TEST_F(JournalTest, ToWhichNothingWasAddedItIsLeftAlone) {
  const std::string untidy = "no record\n" + tidy_ + "half a li";
  std::ofstream(path(name_)) << untidy;
  Journal journal(path(""), "krok-test", "");
  ASSERT_TRUE(journal.tidy());
  EXPECT_EQ(get(path(name_)), untidy);
}

TEST_F(JournalTest, WhereTheNewOneCannotTakeItsPlaceThatIsToldAndNothingIsLeft) {
  Journal journal(path(""), "krok-test", "");
  ASSERT_TRUE(journal.add({{"output", "a.anim"}, {"made_with", "1"}}));
  std::filesystem::remove(path(name_));
  std::filesystem::create_directories(path(name_ + "/in the way"));
  const Status status = journal.tidy();
  ASSERT_FALSE(status);
  EXPECT_EQ(listing(), std::vector<std::string>{name_});
}

}  // namespace
}  // namespace krok::cli::batch
