#pragma once

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/fixture.h"
#include "core/file.h"
#include "support/this_build.h"

namespace krok::test {

// A step library made of generated walks, through the tools.
class StepLibrary : public CliTest {
 protected:
  // Four walks, two lengths of step by two slopes.
  void SetUp() override {
    CliTest::SetUp();
    for (const char* length : {"50", "70"}) {
      for (const char* rise : {"0", "8"}) make_walk(length, rise);
    }
  }
  void make_walk(const std::string& length, const std::string& rise) const {
    const ToolRun made = run({test::make_walk(), "--steps", "4", "--step-length", length + "cm",
                              "--rise", rise + "cm", "--ground", "slope", "-q", "-o",
                              path("walk_" + length + "_" + rise + ".bvh")});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  void describe(const std::string& more = R"("examples": [{"clip": "walk_*.bvh"}])") const {
    write("library.json",
          R"({"schema": "krok.library/1", "steps": "auto",
 "parameters": [{"name": "length", "measures": "step.length"}, {"measures": "step.height"}],
 )" + more + "}");
  }
  void write(const std::string& name, const std::string& text) const {
    ASSERT_TRUE(write_file(path(name), text).ok());
  }
  ToolRun fit(std::vector<std::string> arguments = {}) const {
    arguments.insert(arguments.begin(), path("library.json"));
    arguments.insert(arguments.end(), {"-o", path("out.steps")});
    return run_tool("krok-fit", arguments);
  }
  void fit_well(const std::vector<std::string>& arguments = {}) const {
    describe();
    const ToolRun run = fit(arguments);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  ToolRun synth(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), path("out.steps"));
    if (!testing::Value(arguments, testing::Contains("-o"))) {
      arguments.insert(arguments.end(), {"-o", path("step.anim")});
    }
    return run_tool("krok-synth", arguments);
  }
  nlohmann::json synthesised(std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const ToolRun run = synth(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? nlohmann::json::parse(run.out)["result"]["motions"]
                              : nlohmann::json();
  }
};

}  // namespace krok::test
