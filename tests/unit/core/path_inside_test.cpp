// If these fail, a file from anyone makes a program open what is outside of the file's folder, or a
// good path is refused.

#include "core/path_inside.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "support/folder_test.h"

namespace krok {
namespace {

namespace fs = std::filesystem;

TEST(PathFault, GoodPathsHaveNone) {
  for (const char* path : {"a.png", "textures/a.png", "./a.png", "a/./b", "..a", "a..", "...",
                           "a/b:c", "\xC5\x99 1.png", "-o", ".hidden"}) {
    EXPECT_EQ(path_fault(path), "") << path;
  }
}

TEST(PathFault, PathsThatLeaveOrAreNoneHaveOne) {
  for (const char* path :
       {"", "..", "../a", "a/../../b", "a/..", "/etc/passwd", "C:/a", "c:a", "http://a/b", "data:x",
        "a\\b", "..\\a", "a\nb", "\xFF", "a/", ".", "a/.", "\x7F"}) {
    EXPECT_NE(path_fault(path), "") << path;
  }
  EXPECT_NE(path_fault(std::string_view("a\0b", 3)), "");
  EXPECT_NE(path_fault(std::string(5000, 'a')), "");
}

class PathInside : public test::FolderTest {};

TEST_F(PathInside, IsBelowTheFolder) {
  const auto found = path_inside(folder_.string(), "sub/not_there.png");
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(*found, path("sub/not_there.png"));
  EXPECT_EQ(*path_inside("", "a.png"), "a.png");
  EXPECT_EQ(*path_inside(".", "a.png"), "a.png");
  EXPECT_EQ(path_inside(folder_.string(), "../a").error().code, "path-outside");
}

TEST_F(PathInside, LinksCountAsWhereTheyLead) {
  fs::create_directory(path("in"));
  put("secret", "x");
  put("in/good", "x");
  fs::create_symlink("../secret", path("in/bad"));
  fs::create_directory_symlink("..", path("in/up"));
  fs::create_symlink("good", path("in/fine"));
  EXPECT_TRUE(path_inside(path("in"), "fine").ok());
  EXPECT_EQ(path_inside(path("in"), "bad").error().code, "path-outside");
  EXPECT_EQ(path_inside(path("in"), "up/secret").error().code, "path-outside");
  // The folder itself may be reached by a link.
  fs::create_directory_symlink("in", path("link"));
  EXPECT_TRUE(path_inside(path("link"), "good").ok());
  EXPECT_EQ(path_inside(path("link"), "bad").error().code, "path-outside");
}

TEST(FolderOf, IsNeverEmpty) {
  EXPECT_EQ(folder_of("a.png"), ".");
  EXPECT_EQ(folder_of("b/a.png"), "b");
  EXPECT_EQ(folder_of("/a.png"), "/");
}

}  // namespace
}  // namespace krok
