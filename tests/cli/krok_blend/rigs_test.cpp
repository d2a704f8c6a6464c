// From captures to results through the tools, on the rigs that captures come with. If these fail, a
// walk whose root stands, slides along or lies in its reference pose is read, keyed, blended,
// mirrored or looped to another motion than the same walk with its hips as root.

#include <gtest/gtest.h>

#include "cli/fixture.h"
#include "core/file.h"
#include "formats/anim/anim.h"
#include "support/this_build.h"
#include "unit/blend/rigged_walks.h"

namespace krok::test {
namespace {

class RigsThroughTools : public CliTest {
 protected:
  Clip result(const std::string& rig) const {
    const auto walk = [&](const std::string& name, const std::vector<std::string>& more) {
      std::vector<std::string> command = {test::make_walk(), "-q", "--rig", rig,
                                          "--steps",         "6",  "-o",    path(name)};
      command.insert(command.end(), more.begin(), more.end());
      EXPECT_EQ(run(command).exit_code, 0);
      take_mark_from(name);
    };
    walk("slow.bvh", {"--step-length", "50cm", "--turn", "8deg", "--noise-angle", "0.3deg"});
    walk("quick.bvh", {"--step-length", "80cm", "--cadence", "126"});
    const ToolRun blended = run_tool(
        "krok-blend",
        {path("slow.bvh") + ":0.5", path("quick.bvh") + ":0.5", "-q", "-o", path("blended.anim")});
    EXPECT_EQ(blended.exit_code, 0) << blended.err;
    const ToolRun edited = run_tool(
        "krok-edit", {path("blended.anim"), "--mirror", "--loop", "-q", "-o", path("edited.anim")});
    EXPECT_EQ(edited.exit_code, 0) << edited.err;
    const auto file = InputFile::open(path("edited.anim"));
    EXPECT_TRUE(file.ok());
    auto clip = anim::read(file->bytes());
    EXPECT_TRUE(clip.ok());
    return clip.ok() ? std::move(*clip) : Clip();
  }
};

TEST_F(RigsThroughTools, GiveTheSame) {
  const Clip expected = result("hips");
  for (const char* rig : {"static-root", "ground-root", "lying"}) {
    EXPECT_LT(blend::farthest_by_name(expected, result(rig)), 1e-4) << rig;
  }
}

}  // namespace
}  // namespace krok::test
