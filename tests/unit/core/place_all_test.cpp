// If these fail, a run that failed leaves some of its results behind, or destroys what stood there.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/file.h"
#include "support/folder_test.h"

namespace krok {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class PlaceAllTest : public test::FolderTest {
 protected:
  // "new a" for the file a, and so on.
  std::vector<OutputFile> files(const Names& names, OutputFile::Options options = {}) const {
    std::vector<OutputFile> result;
    for (const std::string& name : names) {
      auto file = OutputFile::create(path(name), options);
      EXPECT_TRUE(file && file->write("new " + name)) << name;
      if (file) result.push_back(std::move(*file));
    }
    return result;
  }
};

TEST_F(PlaceAllTest, AllGetTheirNames) {
  put("b", "old b");
  auto made = files({"a", "b", "c"});
  EXPECT_EQ(get(path("b")), "old b");
  ASSERT_TRUE(OutputFile::place_all(made));
  EXPECT_EQ(listing(), (Names{"a", "b", "c"}));
  for (const char* name : {"a", "b", "c"}) {
    EXPECT_EQ(get(path(name)), std::string("new ") + name);
  }
}

TEST_F(PlaceAllTest, OfNoneNothingIsDone) {
  EXPECT_TRUE(OutputFile::place_all({}));
}

// The last one cannot get its name: a folder that is not empty took it meanwhile.
TEST_F(PlaceAllTest, AFailureTakesBackTheOthers) {
  put("b", "old b");
  auto made = files({"a", "b", "c", "d"});
  fs::create_directories(path("c/inside"));
  const Status status = OutputFile::place_all(made);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().where.file, path("c"));
  EXPECT_EQ(listing(), (Names{"b", "c"}));
  EXPECT_EQ(get(path("b")), "old b");
}

TEST_F(PlaceAllTest, NoClobberTakesBackTheOthersToo) {
  auto made = files({"a", "b"}, {.no_clobber = true});
  put("b", "other");
  const Status status = OutputFile::place_all(made);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, "file-exists");
  EXPECT_EQ(listing(), Names{"b"});
  EXPECT_EQ(get(path("b")), "other");
}

TEST_F(PlaceAllTest, AFailureToWriteOneIsOneOfAll) {
  auto made = files({"a"});
  auto full = OutputFile::create("/dev/full");
  ASSERT_TRUE(full && full->write("text"));
  made.push_back(std::move(*full));
  EXPECT_FALSE(OutputFile::place_all(made));
  EXPECT_EQ(listing(), Names{});
}

// A program may have few files open at a time.
TEST_F(PlaceAllTest, SealedFilesTakeNoDescriptors) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few{64, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  std::vector<OutputFile> made;
  for (int i = 0; i < 300; ++i) {
    auto file = OutputFile::create(path(std::to_string(i)), {.stored_later = true});
    ASSERT_TRUE(file) << i;
    ASSERT_TRUE(file->write("text") && file->seal()) << i;
    EXPECT_EQ(get(file->written_at()), "text");
    made.push_back(std::move(*file));
  }
  EXPECT_TRUE(OutputFile::place_all(made));
  EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(listing().size(), 300u);
}

}  // namespace
}  // namespace krok
