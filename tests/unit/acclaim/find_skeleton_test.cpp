// If these fail, a motion is played on another actor's skeleton, or its own is not found.

#include "formats/acclaim/acclaim_reader.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

namespace krok::acclaim {
namespace {

class FindSkeleton : public testing::Test {
 protected:
  FindSkeleton() {
    std::string name =
        (std::filesystem::temp_directory_path() / "krok-find-skeleton-XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  ~FindSkeleton() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  void put(const std::string& name) const { std::ofstream(folder_ / name) << ":version 1.10\n"; }

  // The name of the file found, or the code of the error.
  std::string found(const std::string& motion) const {
    const auto skeleton = find_skeleton((folder_ / motion).string());
    if (!skeleton) return skeleton.error().code;
    EXPECT_EQ(std::filesystem::path(skeleton->path).parent_path(), folder_);
    EXPECT_FALSE(skeleton->reason.empty());
    return std::filesystem::path(skeleton->path).filename().string();
  }

  std::filesystem::path folder_;
};

TEST_F(FindSkeleton, TheOneWhoseNameBeginsTheMotions) {
  for (const char* name : {"01.asf", "1.asf", "11.ASF", "11_01.amc", "01_01.bvh"}) put(name);
  EXPECT_EQ(found("01_01.amc"), "01.asf");
  EXPECT_EQ(found("11_01.amc"), "11.ASF");
  EXPECT_EQ(found("1-2.amc"), "1.asf");
  EXPECT_EQ(found("111_01.amc"), "acclaim-skeleton");
  put("01_01.asf");
  EXPECT_EQ(found("01_01.amc"), "01_01.asf");
  EXPECT_EQ(found("01_02.amc"), "01.asf");
}

TEST_F(FindSkeleton, TheOnlyOneWhateverItsName) {
  EXPECT_EQ(found("walk.amc"), "acclaim-skeleton");
  put("actor.asf");
  EXPECT_EQ(found("walk.amc"), "actor.asf");
  put("another.asf");
  EXPECT_EQ(found("walk.amc"), "acclaim-skeleton");
}

TEST_F(FindSkeleton, CaseAloneDoesNotDecide) {
  put("walk.asf");
  put("WALK.asf");
  EXPECT_EQ(found("walk_1.amc"), "acclaim-skeleton");
}

TEST_F(FindSkeleton, AFolderThatIsNotThereIsAnError) {
  EXPECT_EQ(found("nowhere/walk.amc"), "acclaim-skeleton");
}

}  // namespace
}  // namespace krok::acclaim
