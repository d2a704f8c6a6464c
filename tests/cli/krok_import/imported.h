#pragma once

#include "cli/fixture.h"
#include "core/file.h"
#include "formats/anim/anim.h"

namespace krok::test {

// What krok-import makes of `arguments`, through the file `output`; a failure of the test where it
// does not.
inline Clip imported_clip(std::vector<std::string> arguments, const std::string& output) {
  arguments.insert(arguments.end(), {"-o", output});
  const ToolRun run = run_tool("krok-import", arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto file = InputFile::open(output);
  EXPECT_TRUE(file.ok());
  if (!file.ok()) return {};
  auto clip = anim::read(file->bytes());
  EXPECT_TRUE(clip.ok());
  return clip.ok() ? std::move(*clip) : Clip();
}

}  // namespace krok::test
