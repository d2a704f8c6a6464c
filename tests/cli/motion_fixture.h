#pragma once

#include <utility>

#include "cli/fixture.h"
#include "core/file.h"
#include "formats/anim/anim.h"
#include "samples/generator/walk.h"

namespace krok::test {

// A folder with motions in it.
class MotionTest : public CliTest {
 protected:
  void write(const std::string& name, const Clip& clip,
             const anim::WriteOptions& options = {}) const {
    auto file = OutputFile::create(path(name));
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(anim::write(clip, options, *file).ok());
    ASSERT_TRUE(file->commit().ok());
  }

  // A generated walk at 60 frames/s, in walk.anim.
  Clip write_walk(int steps) const {
    samples::WalkOptions options;
    options.steps = steps;
    options.rate = 60;
    Clip walk = samples::make_walk(options)->clip;
    write("walk.anim", walk);
    return walk;
  }

  // The report of a tool that must not fail, run in the folder.
  json report_here(const std::string& tool, std::vector<std::string> arguments) const {
    arguments.emplace_back("--json");
    const ToolRun run = run_here(tool, std::move(arguments));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return json::parse(run.out);
  }

  Clip read(const std::string& name) const {
    const auto file = InputFile::open(path(name));
    EXPECT_TRUE(file.ok()) << name;
    auto clip = anim::read(file->bytes());
    EXPECT_TRUE(clip.ok()) << name;
    return std::move(*clip);
  }
};

}  // namespace krok::test
