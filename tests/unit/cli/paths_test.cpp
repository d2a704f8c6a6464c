// If these fail, one file passes for two, or two for one: a result replaces its own input, or files
// of a batch are refused that have nothing to do with each other.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "support/folder_test.h"
#include "tools/cli/paths.h"

namespace krok::cli {
namespace {

namespace fs = std::filesystem;

class PathsTest : public test::FolderTest {};

TEST_F(PathsTest, AnAbsolutePathIsTheOneOfTheLibrary) {
  for (const char* written :
       {"a", "a/b", "./a", "a/./b", "a/../b", "../a", "a//b", "a/", "/", "/a", "//a", "/a/b", "/a/",
        "/a/..", ".", "..", "...", ".a/..b/c.", "a b/\xff"}) {
    EXPECT_EQ(absolute_path(written), fs::absolute(written).lexically_normal().string()) << written;
  }
}

TEST_F(PathsTest, AllNamesOfAFileLeadToOnePlace) {
  fs::create_directories(path("folder/sub"));
  std::ofstream(path("folder/file")) << "x";
  fs::create_symlink("folder", path("link"));
  fs::create_symlink("folder/file", path("link to file"));
  const std::string place = place_of(path("folder/file"));
  EXPECT_EQ(place, fs::canonical(path("folder/file")).string());
  for (const char* name : {"link/file", "folder/sub/../file", "folder//file", "link to file"}) {
    EXPECT_EQ(place_of(path(name)), place) << name;
  }
  // What is not there yet.
  const std::string none = place_of(path("folder/none"));
  EXPECT_NE(none, place);
  EXPECT_EQ(place_of(path("link/none")), none);
  EXPECT_EQ(place_of(path("no folder/none")), path("no folder/none"));
  EXPECT_EQ(place_of("/none"), "/none");
  EXPECT_EQ(place_of("-"), "");
  EXPECT_EQ(place_of("/dev/null"), "");
}

}  // namespace
}  // namespace krok::cli
