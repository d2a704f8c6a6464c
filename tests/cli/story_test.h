#pragma once

#include <string>

#include "cli/fixture.h"
#include "support/folder_test.h"
#include "support/run_tool.h"
#include "support/this_build.h"

namespace krok::test {

// Runs the story in samples/NAME in a new folder.
class StoryTest : public FolderTest {
 protected:
  explicit StoryTest(std::string name)
      : folder_of_story_(test::source_folder() + "/samples/" + std::move(name) + "/") {}

  // A file of the story's own.
  std::string told(const std::string& file) const { return get(folder_of_story_ + file); }

  // Its script, on tools of another folder where `bin` is given.
  ToolRun story(const std::string& arguments, const std::string& bin = test::tools_folder()) const {
    ToolOptions options;
    options.folder = folder_.string();
    options.timeout = 600;
    return run({"/bin/sh", "-c",
                "KROK_BIN='" + bin + "' SAMPLES_BIN='" + test::sample_programs() + "' '" +
                    folder_of_story_ + "run.sh' " + arguments},
               options);
  }

  // Tools that are not there are named, with what to do.
  void expect_missing_tools_told(const std::string& first_missing) const {
    const ToolRun run = story("", "/nowhere");
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find("no " + first_missing + " in /nowhere"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("hint:"), std::string::npos) << run.err;
  }

 private:
  const std::string folder_of_story_;
};

}  // namespace krok::test
