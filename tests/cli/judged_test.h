#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/fixture.h"
#include "support/this_build.h"

namespace krok::test {

// What tools write, before programs that we did not write.
class JudgedTest : public CliTest {
 protected:
  // Runs a script of tests/golden over files of this folder; skips without its packages.
  void judge(const std::vector<std::string>& arguments) const {
    const std::filesystem::path tests = std::filesystem::path(test::source_folder()) / "tests";
    for (const char* needed : {"gltf-validator", "three"}) {
      if (!std::filesystem::exists(tests / "node_modules" / needed)) {
        GTEST_SKIP() << "skipped: no " << needed << " in tests/node_modules; run npm ci in tests/";
      }
    }
    std::vector<std::string> command = {"/usr/bin/env", "node",
                                        (tests / "golden" / arguments[0]).string()};
    command.insert(command.end(), arguments.begin() + 1, arguments.end());
    ToolOptions options;
    options.folder = folder_.string();
    const ToolRun run = test::run(command, options);
    EXPECT_EQ(run.exit_code, 0) << arguments[0] << "\n" << run.out << run.err;
  }
};

}  // namespace krok::test
