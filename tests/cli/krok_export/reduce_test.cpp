// If these fail, --reduce writes another motion than it says, or is taken where it means nothing.

#include <cmath>

#include "cli/fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class ExportReduced : public CliTest {
 protected:
  static std::string tool(const char* name) { return test::tools_folder() + "/" + name; }
  ToolRun export_as(const std::string& output, const std::vector<std::string>& options) const {
    std::vector<std::string> line = {tool("krok-export"), path("walk.bvh"), "-o", path(output)};
    line.insert(line.end(), options.begin(), options.end());
    return run(line);
  }
  void SetUp() override {
    CliTest::SetUp();
    put("walk.bvh", curved_capture(400));
  }
  // The fixture's joints on curves, so that no few keys have them exactly.
  static std::string curved_capture(int frames) {
    std::string text = capture(0);
    const std::string none = "Frames: 0";
    text.replace(text.find(none), none.size(), "Frames: " + std::to_string(frames));
    for (int f = 0; f < frames; ++f) {
      const auto wave = [&](double rate) { return std::to_string(30 * std::sin(rate * f)); };
      text += "0 1 0 " + wave(0.11) + " 0 " + wave(0.07) + " 5 " + wave(0.13) + " 0 0 0 " +
              wave(0.2) + "\n";
    }
    return text;
  }
};

TEST_F(ExportReduced, IsTheSameMotionWithinTheTolerance) {
  ASSERT_EQ(export_as("all.glb", {}).exit_code, 0);
  const ToolRun reduced = export_as("reduced.glb", {"--reduce", "1mm"});
  ASSERT_EQ(reduced.exit_code, 0) << reduced.err;
  EXPECT_NE(reduced.err.find(" keys, max error "), std::string::npos) << reduced.err;
  EXPECT_LT(get(path("reduced.glb")).size(), get(path("all.glb")).size());
  // A turn by two degrees moves points 3 cm away by a millimetre.
  const ToolRun same = run({tool("krok-diff"), path("all.glb"), path("reduced.glb"), "--tolerance",
                            "1mm", "--angle", "2deg"});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
  const ToolRun other = run({tool("krok-diff"), path("all.glb"), path("reduced.glb"), "--tolerance",
                             "0.01mm", "--angle", "2deg"});
  EXPECT_EQ(other.exit_code, 1) << other.out << other.err;
}

TEST_F(ExportReduced, ReportsWhatItLeft) {
  const ToolRun reduced = export_as("reduced.glb", {"--reduce", "1mm", "--json"});
  ASSERT_EQ(reduced.exit_code, 0) << reduced.err;
  for (const char* key : {"\"keys\":", "\"keys_before\":", "\"largest_error\":"}) {
    EXPECT_NE(reduced.out.find(key), std::string::npos) << reduced.out;
  }
}

TEST_F(ExportReduced, BytesDoNotDependOnTheNumberOfThreads) {
  put("walk.bvh", curved_capture(3000));
  ASSERT_EQ(export_as("1.glb", {"--reduce", "1mm", "-j", "1"}).exit_code, 0);
  ASSERT_EQ(export_as("3.glb", {"--reduce", "1mm", "-j", "3"}).exit_code, 0);
  EXPECT_TRUE(get(path("1.glb")) == get(path("3.glb")));
}

TEST_F(ExportReduced, IsRefusedWhereItMeansNothing) {
  for (const auto& [tolerance, code] : {std::pair("0", "usage"),
                                        {"-1mm", "usage"},
                                        {"nan", "quantity-number"},
                                        {"much", "quantity-number"},
                                        {"5deg", "quantity-unit"}}) {
    const ToolRun refused = export_as("out.glb", {"--reduce", tolerance});
    EXPECT_EQ(refused.exit_code, 2) << tolerance;
    EXPECT_TRUE(has_code(refused.err, code)) << refused.err;
  }
  const ToolRun bvh = export_as("out.bvh", {"--reduce", "1mm"});
  EXPECT_EQ(bvh.exit_code, 2);
  EXPECT_TRUE(has_code(bvh.err, "usage")) << bvh.err;
  EXPECT_EQ(listing(), std::vector<std::string>{"walk.bvh"});
}

}  // namespace
}  // namespace krok::test
