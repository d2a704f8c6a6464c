// If these fail, the story of the step library no longer holds: libraries are less right than its
// page says, or its script does not run.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "cli/made_once.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

const std::string kStory = test::source_folder() + "/samples/step_library/";

class StepLibraryStory : public testing::Test {
 protected:
  // In "a folder", once for all tests.
  static Made story() {
    return made_once("step library", kStory, [](const fs::path& folder) {
      ToolOptions options;
      options.folder = folder.string();
      options.timeout = 600;
      return run({"/bin/sh", "-c",
                  "KROK_BIN='" + test::tools_folder() + "' SAMPLES_BIN='" +
                      test::sample_programs() + "' '" + kStory + "run.sh' 'a folder'"},
                 options);
    });
  }
  // The errors before and after of a parameter, from the lines of the refined libraries.
  static std::pair<double, double> printed(const std::string& text, int row) {
    std::size_t at = text.find("\nwalking.steps: ");
    for (int k = 0; k <= row; ++k) {
      at = text.find(": error ", at + 1);
      if (at == std::string::npos) return {0, 0};
    }
    const std::size_t after = text.find("before, ", at);
    return {std::stod(text.substr(at + 8)), std::stod(text.substr(after + 8))};
  }
  static std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

double largest(const json& actors, const char* name) {
  return actors["within"][name]["largest"].get<double>();
}

TEST_F(StepLibraryStory, HoldsWhatItsReadmeTells) {
  const auto [folder, run] = story();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const fs::path out = folder / "a folder";
  for (const char* made :
       {"walking.steps", "turning.steps", "step.anim", "step.keys.json", "step_right.anim",
        "bend.anim", "sheet/step_5.anim", "steps.png", "charts/errors.svg", "charts/weights.svg",
        "charts_turns/measured.svg", "charts_turns/parameters.svg"}) {
    EXPECT_TRUE(fs::exists(out / made)) << made;
  }
  // Each line of the page's table, about as krok-fit prints it: the last digits are not the same on
  // every machine.
  const std::string readme = text_of(kStory + "README.md");
  const std::size_t begin_of_table = readme.find("| library | parameter |");
  ASSERT_NE(begin_of_table, std::string::npos);
  const std::string table =
      readme.substr(begin_of_table, readme.find("\n\n", begin_of_table) + 1 - begin_of_table);
  constexpr const char* kReports[] = {"fit.json", "fit_turns.json", "fit_widths.json"};
  std::size_t library = 0;
  json report;
  int rows = 0;
  for (std::size_t at = 0; (at = table.find("\n| ", at)) != std::string::npos; ++at) {
    const std::string row = table.substr(at + 1, table.find('\n', at + 1) - at - 1);
    std::vector<std::string> cells;
    for (std::size_t begin = 1; begin < row.size();) {
      const std::size_t end = row.find(" |", begin);
      if (end == std::string::npos) break;
      cells.push_back(row.substr(std::min(begin + 1, end), end - std::min(begin + 1, end)));
      begin = end + 2;
    }
    if (cells.size() < 5 || cells.back().find_first_of("0123456789") != 0) continue;
    const auto [before, after] = printed(run.err, rows);
    if (!cells[0].empty()) {
      ASSERT_LT(library, std::size(kReports)) << row;
      report = json::parse(text_of(out / kReports[library++]))["result"];
    }
    const double refined = largest(report["rounds"].back()["after"], cells[1].c_str()) *
                           (cells[1] == "turn" ? 1 : 1000);
    EXPECT_NEAR(std::stod(cells[2]), before, 0.25 * before) << row;
    EXPECT_NEAR(std::stod(cells[3]), refined, 0.25 * refined) << row;
    EXPECT_NEAR(std::stod(cells[4]), after, 0.25 * after) << row;
    ++rows;
  }
  EXPECT_EQ(rows, 9) << "the table has another form";
}

// Steps that contradict each other: what is chosen predicts clips that are left out about as well
// as the best of all that was tried, and better than weights that reproduce each step; the page's
// figures are those.
TEST_F(StepLibraryStory, ChoosesWeightsForStepsThatContradictEachOther) {
  const auto [folder, run] = story();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const fs::path out = folder / "a folder";
  const json report = json::parse(text_of(out / "fit_captured.json"))["result"];
  const json tried = report["clips_left_out"];
  EXPECT_GE(tried["examples"], 30);
  EXPECT_GE(tried["clips"], 8);
  double chosen = 0, best = tried["planes"], cubic = 0;
  for (const json& trial : tried["weights"]) {
    if (trial["failed"] > 0) continue;
    const double error = trial["error"];
    best = std::min(best, error);
    if (trial["kernel"] == "cubic" && trial["smoothing"] == 0) cubic = error;
    if (trial["kernel"] == report["kernel"] && trial["smoothing"] == report["smoothing"]) {
      chosen = error;
    }
  }
  ASSERT_GT(chosen, 0);
  EXPECT_LE(chosen, 1.05 * best);
  EXPECT_LE(chosen, 1.05 * std::min(tried["planes"], tried["nearest"]).get<double>());
  EXPECT_LT(chosen, 0.95 * cubic);
  const std::string readme = text_of(kStory + "README.md");
  for (const double figure : {chosen, cubic, tried["nearest"].get<double>()}) {
    const std::string text = fmt::format("{:.1f} mm", 1e3 * figure);
    EXPECT_NE(readme.find(text), std::string::npos) << "the page has no " << text;
  }
  // Consistent steps are reproduced.
  const json exact = json::parse(text_of(out / "fit.json"))["result"];
  EXPECT_EQ(exact["kernel"], "cubic");
  EXPECT_EQ(exact["smoothing"], 0);
}

// Published for a prototype of the method: 2 mm at 20 inserted points and 0.3 mm at 80 with two
// parameters; 5 mm at 40, 1 mm and 0.1 degrees at 160 with three.
TEST_F(StepLibraryStory, ErrorsAreWithinTheTargets) {
  const auto [folder, run] = story();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const fs::path out = folder / "a folder";
  const json two = json::parse(text_of(out / "fit.json"))["result"];
  EXPECT_LE(two["inserted"].get<int>(), 20);
  const json& two_last = two["polished"]["after"];
  for (const char* name : {"length", "height"}) EXPECT_LT(largest(two_last, name), 0.3e-3);
  EXPECT_GT(two_last["least_weight"].get<double>(), -0.15);
  EXPECT_LT(two_last["roughness"].get<double>(), 1.1 * two["before"]["roughness"].get<double>());

  const json three = json::parse(text_of(out / "fit_turns.json"))["result"];
  EXPECT_LE(three["inserted"].get<int>(), 160);
  const json& three_last = three["polished"]["after"];
  for (const char* name : {"length", "height"}) {
    EXPECT_LT(largest(three_last, name), 1e-3);
    EXPECT_GT(largest(three["before"], name), 10 * largest(three_last, name));
  }
  EXPECT_LT(largest(three_last, "turn"), 0.1);
  int inserted = 0;
  for (const json& round : three["rounds"]) {
    inserted += round["inserted"].get<int>();
    if (inserted > 40) break;
    if (inserted == 40) {
      EXPECT_LT(largest(round["after"], "length"), 5e-3);
      EXPECT_LT(largest(round["after"], "height"), 5e-3);
    }
  }
}

}  // namespace
}  // namespace krok::test
