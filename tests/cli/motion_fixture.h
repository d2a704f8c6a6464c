#pragma once

#include <utility>

#include "cli/fixture.h"
#include "core/file.h"
#include "formats/anim/anim.h"

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

  Clip read(const std::string& name) const {
    const auto file = InputFile::open(path(name));
    EXPECT_TRUE(file.ok()) << name;
    auto clip = anim::read(file->bytes());
    EXPECT_TRUE(clip.ok()) << name;
    return std::move(*clip);
  }
};

}  // namespace krok::test
