// Step libraries of captures on the four rigs that captures come with. If these fail, a library is
// cut, refined or measured otherwise where the root does not move with the hips or the reference
// pose lies.

#include "cli/step_library/library_fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

using nlohmann::json;

class StepLibraryOfRig : public StepLibrary, public testing::WithParamInterface<const char*> {
 protected:
  // Nine walks of three step lengths on three slopes.
  void SetUp() override {
    for (const char* length : {"50", "65", "80"}) {
      for (const char* rise : {"-12", "0", "12"}) {
        const std::string name = std::string("walk_") + length + "_" + rise + ".bvh";
        const ToolRun made =
            run({test::make_walk(), "--rig", GetParam(), "--steps", "6", "--step-length",
                 std::string(length) + "cm", "--rise", std::string(rise) + "cm", "--ground",
                 "slope", "-q", "-o", path(name)});
        ASSERT_EQ(made.exit_code, 0) << made.err;
      }
    }
    write("library.json", R"({"schema": "krok.library/1", "steps": "auto", "swing": "left",
 "parameters": [{"name": "length", "measures": "step.length", "tolerance": "0.1mm"},
                {"name": "height", "measures": "step.height", "tolerance": "0.1mm"}],
 "examples": [{"clip": "walk_*.bvh"}]})");
  }
};

INSTANTIATE_TEST_SUITE_P(StepLibraryRigs, StepLibraryOfRig,
                         testing::Values("hips", "static-root", "ground-root", "lying"),
                         [](const auto& test_case) {
                           std::string name = test_case.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

// Refinement reaches 0.1 mm, examples left out come back to 15 mm where the nearest one is 60 mm
// off, and a corrected step has its parameters. Measured on all four rigs: errors of heights of
// 0.134 mm before, 0.085 after.
TEST_P(StepLibraryOfRig, HoldsItsFigures) {
  const ToolRun fitted = fit({"-q", "--json=" + path("fit.json")});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  const json report = json::parse(InputFile::open(path("fit.json"))->text())["result"];
  ASSERT_EQ(report["examples"].size(), 9U);
  for (const char* parameter : {"length", "height"}) {
    const double before = report["before"]["within"][parameter]["largest"];
    const double after = report["polished"]["after"]["within"][parameter]["largest"];
    EXPECT_LT(before, 0.4e-3) << parameter;
    EXPECT_LT(after, 0.1e-3) << parameter;
    EXPECT_LT(after, before) << parameter;
  }
  EXPECT_LT(report["leave_one_out"]["weighted"], 0.015);
  EXPECT_GT(report["leave_one_out"]["nearest"], 0.06);
  EXPECT_EQ(
      synth({"--set", "length=57cm", "--set", "height=3cm", "--correct", "--strict"}).exit_code, 0);
}

}  // namespace
}  // namespace krok::test
