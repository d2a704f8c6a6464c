// If these fail, a capture that is exported straight away shows another motion than one that is
// imported first, or its faults are told wrongly.

#include <filesystem>

#include "cli/fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class ExportCapture : public CliTest {
 protected:
  static std::string tool(const char* name) { return test::tools_folder() + "/" + name; }

  ToolRun export_to(const std::string& input, const std::string& output,
                    const std::string& option = "-v") const {
    return run({tool("krok-export"), input, "-o", path(output), option});
  }

  // Frames, of which the one in the middle lacks a number.
  static std::string broken_capture() {
    std::string text = capture(400);
    const std::size_t row = text.find("0 1 0 80 ");
    text.erase(row, 2);
    return text;
  }

  static std::size_t count(const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++found;
    return found;
  }
};

TEST_F(ExportCapture, ShowsTheMotionThatIsImportedFirst) {
  const std::string bvh = put("walk.bvh", capture(400));
  ASSERT_EQ(
      run({tool("krok-import"), bvh, "-o", path("walk.anim"), "--orientation", "xyzw"}).exit_code,
      0);
  for (const std::string end : {".glb", ".gltf", ".bvh", ".csv"}) {
    const ToolRun straight = export_to(bvh, "straight" + end);
    EXPECT_EQ(straight.exit_code, 0) << straight.err;
    EXPECT_TRUE(has_code(straight.err, "bvh-rate")) << straight.err;
    EXPECT_EQ(export_to(path("walk.anim"), "imported" + end).exit_code, 0);
  }
  // The hierarchies differ by the rounding of the reference pose in a .anim file.
  const auto rows = [&](const char* name) {
    const std::string text = get(path(name));
    return text.substr(text.find("MOTION"));
  };
  EXPECT_TRUE(rows("straight.bvh") == rows("imported.bvh"));
  EXPECT_TRUE(get(path("straight.csv")) == get(path("imported.csv")));
  const ToolRun same = run({tool("krok-diff"), path("straight.glb"), path("imported.glb")});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
}

TEST_F(ExportCapture, BytesDoNotDependOnTheNumberOfThreads) {
  const std::string bvh = put("walk.bvh", capture(1000));
  ASSERT_EQ(run({tool("krok-export"), bvh, "-o", path("1.glb"), "-j", "1"}).exit_code, 0);
  ASSERT_EQ(run({tool("krok-export"), bvh, "-o", path("3.glb"), "-j", "3"}).exit_code, 0);
  EXPECT_EQ(get(path("1.glb")), get(path("3.glb")));
}

TEST_F(ExportCapture, TellsAFaultOnce) {
  const std::string bvh = put("broken.bvh", broken_capture());
  for (const std::string end : {".glb", ".csv"}) {
    const ToolRun done = export_to(bvh, "out" + end);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_EQ(count(done.err, "[bvh-channel-count]"), 1u) << done.err;
    EXPECT_EQ(count(done.err, "[bvh-rate]"), 1u) << done.err;
  }
}

TEST_F(ExportCapture, RefusesASkeletonWithoutAMotion) {
  const std::string asf =
      put("a.asf", ":version 1.10\n:name a\n:units\n mass 1\n length 0.45\n angle deg\n");
  const ToolRun done = export_to(asf, "out.glb");
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_TRUE(has_code(done.err, "usage")) << done.err;
  EXPECT_EQ(listing(), std::vector<std::string>{"a.asf"});
}

TEST_F(ExportCapture, TakesAnAcclaimMotionWithItsSkeletonBeside) {
  const std::string folder = test::corpus_folder() + "/other/asf_amc_cmu";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no corpus at " << folder;
  std::string amc;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".amc" && (amc.empty() || entry.path().string() < amc)) {
      amc = entry.path().string();
    }
  }
  ASSERT_FALSE(amc.empty());
  const ToolRun done = export_to(amc, "out.glb");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(has_code(done.err, "acclaim-skeleton")) << done.err;
  EXPECT_GT(get(path("out.glb")).size(), 10000u);
}

// The import of a file that proves faulty only after much of it was written.
TEST_F(ExportCapture, ImportTellsALateFaultOnceAndKeepsTheWholeRows) {
  std::string text = capture(5000);
  const std::size_t row = text.rfind("0 1 0 80 ");
  text.erase(row, 2);
  const std::string bvh = put("broken.bvh", text);
  const ToolRun done =
      run({tool("krok-import"), bvh, "-o", path("out.anim"), "-v", "--json=" + path("out.json")});
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(count(done.err, "[bvh-channel-count]"), 1u) << done.err;
  EXPECT_EQ(count(done.err, "[bvh-rate]"), 1u) << done.err;
  EXPECT_NE(get(path("out.json")).find("\"frames\": 4999"), std::string::npos);
  EXPECT_EQ(count(get(path("out.json")), "\"path\": "), 1u);
}

}  // namespace
}  // namespace krok::test
