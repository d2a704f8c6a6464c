// If these fail, an option value that fits no file is found out file by file, after others were
// done, or a tool that takes many files has no such value checked at all.

#include <gmock/gmock.h>

#include "batch_fixture.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

struct Value {
  std::string tool;
  Names options;
  std::string code;
};

void PrintTo(const Value& value, std::ostream* out) {
  *out << value.tool;
  for (const std::string& word : value.options) *out << " " << word;
}

// Of each tool that takes many files: values that no parser of words refuses.
const std::vector<Value>& values() {
  static const std::vector<Value> list = {
      {"krok-import", {"--fps", "abc"}, "usage"},
      {"krok-import", {"--rate", "0"}, "usage"},
      {"krok-import", {"--unit", "furlong"}, "usage"},
      {"krok-import", {"--up", "w"}, "usage"},
      {"krok-import", {"--up", "z", "--forward", "-z"}, "usage"},
      {"krok-import", {"--save-model", "{name}.glb"}, "usage"},
      {"krok-export", {"--format", "bvh", "--unit", "furlong"}, "usage"},
      {"krok-export", {"--format", "glb", "--unit", "cm"}, "export-unit"},
      {"krok-export", {"--format", "csv", "--digits", "3"}, "usage"},
      {"krok-export", {"--format", "bvh", "--no-bones"}, "usage"},
      {"krok-body", {"--pose", "upright"}, "usage"},
      {"krok-body", {"--pose", "-1"}, "usage"},
      {"krok-retarget", {"--onto", "x.model", "--scale", "-1"}, "usage"},
      {"krok-retarget", {"--onto", "x.model", "--reference-pose", "first"}, "usage"},
      {"krok-retarget", {"--onto", "x.model", "--onto-reference-pose", "-2"}, "usage"},
      {"krok-retarget", {"--onto", "x.model", "--ground", "slope:80deg"}, "ground-value"},
      {"krok-retarget", {"--onto", "x.model", "--contacts", "find"}, "usage"},
      {"krok-skin", {"x.model", "--as", "pose", "--time", "5deg"}, "quantity-unit"},
      {"krok-skin", {"x.model", "--from", "-1s"}, "usage"},
      {"krok-skin", {"x.model", "--time", "1s"}, "usage"},
      {"krok-skin", {"x.model", "--as", "rig", "--method", "rigid"}, "usage"},
      {"krok-keys", {"--discard-edits", "--find", "none"}, "usage"},
      {"krok-keys", {"--keytime", "left_strike"}, "usage"},
      {"krok-cam", {"--orbit", "0s"}, "usage"},
      {"krok-cam", {"--follow", "hips", "--smooth", "-1"}, "usage"},
      {"krok-plot", {"--draw", "wavy"}, "usage"},
      {"krok-plot", {"--from", "-1s"}, "usage"},
      {"krok-plot", {"--to", "5deg"}, "quantity-unit"},
      {"krok-plot", {"--show", "toes"}, "usage"},
      {"krok-plot", {"--joint", "Hips", "--euler", "XXY"}, "usage"},
      {"krok-plot", {"--panel", "340"}, "usage"},
      {"krok-plot", {"--ground", "stairs:rise=5kg"}, "ground-value"},
      {"krok-edit", {"--filter", "butterworth", "--cutoff", "-1"}, "usage"},
      {"krok-edit", {"--filter", "butterworth", "--cutoff", "6m"}, "quantity-unit"},
      {"krok-edit", {"--filter", "butterworth", "--filter-order", "3"}, "filter-order"},
      {"krok-edit", {"--filter", "savgol", "--window", "4"}, "filter-window"},
      {"krok-edit",
       {"--filter", "savgol", "--window", "5", "--filter-order", "5"},
       "filter-degree"},
      {"krok-edit", {"--spikes", "--spike-threshold", "0"}, "usage"},
      {"krok-edit", {"--playback-speed", "0"}, "usage"},
      {"krok-edit", {"--rate", "-30"}, "usage"},
      {"krok-edit", {"--scale", "-1"}, "usage"},
      {"krok-edit", {"--height", "0m"}, "usage"},
      {"krok-edit", {"--from", "-1s"}, "usage"},
      {"krok-edit", {"--turn", "5m"}, "quantity-unit"},
      {"krok-edit", {"--move", "1,2"}, "usage"},
      {"krok-edit", {"--loop", "--rounds", "0"}, "usage"},
      {"krok-render", {"--rate", "0"}, "usage"},
      {"krok-ik", {"--goals", "x.goals", "--depth", "-1"}, "usage"},
      {"krok-ik", {"--goals", "x.goals", "--fade", "-1s"}, "usage"},
      {"krok-ik", {"--goals", "x.goals", "--plot", "x.txt"}, "usage"},
      {"krok-ik", {"--goals", "x.goals", "--reach", "Hand=0m,0m@1s"}, "usage"},
      {"krok-ragdoll", {"--at", "-1s"}, "usage"},
      {"krok-ragdoll", {"--at", "1s", "--push", "Chest=1,2"}, "usage"},
      {"krok-ragdoll", {"--at", "1s", "--mass", "0kg"}, "usage"},
      {"krok-ragdoll", {"--powered", "1.5"}, "usage"},
      {"krok-ragdoll", {"--hold", "-0.1"}, "usage"},
      {"krok-ragdoll", {"--simulated", "left_upper_arm", "--hold", "0.5"}, "usage"},
      {"krok-ragdoll", {"--powered", "1", "--push-every", "0s"}, "usage"},
      {"krok-ragdoll", {"--seed", "-1"}, "usage"},
      {"krok-ragdoll", {"--powered", "1", "--until", "2s", "--duration", "2s"}, "usage"},
      {"krok-ragdoll", {"--at", "1s", "--pushes", "x.csv"}, "usage"},
      {"krok-ragdoll", {"--bodies", "x.ragdoll.json", "--mass", "80kg"}, "usage"},
      {"krok-ragdoll", {"--save-bodies", "x.txt"}, "usage"}};
  return list;
}

class OptionValues : public BatchTest, public testing::WithParamInterface<Value> {
 protected:
  // Whatever the tool reads, it must not get as far as reading it.
  void SetUp() override {
    put("a.anim", "no motion");
    put("b.anim", "no motion");
  }
};

TEST_P(OptionValues, AreToldOnceBeforeAnyFileIsDone) {
  const auto& [name, options, code] = GetParam();
  Names arguments = options;
  arguments.insert(arguments.end(),
                   {"a.anim", "b.anim", "--out-dir", "out", "--keep-going", "--json"});
  const ToolRun run = tool(name, arguments);
  EXPECT_EQ(run.exit_code, 2) << run.err;
  const Json report = Json::parse(run.out);
  ASSERT_EQ(report["issues"].size(), 1u) << run.err;
  EXPECT_EQ(report["issues"][0]["code"], code) << run.err;
  EXPECT_TRUE(!report.contains("files") || report["files"].empty()) << run.out;
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_P(OptionValues, OfALineHaveItsPlace) {
  const auto& [name, options, code] = GetParam();
  // Positionals and what is required stand on the command line.
  Names arguments, words;
  for (std::size_t i = 0; i < options.size(); ++i) {
    const bool of_all = options[i] == "x.model" || options[i] == "--onto" ||
                        options[i] == "x.goals" || options[i] == "--goals";
    (of_all ? arguments : words).push_back(options[i]);
  }
  std::string list = "a.anim\tout/a.x\n\nb.anim\tout/b.x\t";
  for (std::size_t i = 0; i < words.size(); ++i) list += (i == 0 ? "" : " ") + words[i];
  put("list.tsv", list + "\n");
  arguments.insert(arguments.end(), {"--manifest", "list.tsv", "--keep-going"});
  const ToolRun run = tool(name, arguments);
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_THAT(run.err, HasSubstr("list.tsv:3:")) << run.err;
  EXPECT_TRUE(has_code(run.err, code)) << run.err;
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

INSTANTIATE_TEST_SUITE_P(Tools, OptionValues, testing::ValuesIn(values()),
                         [](const auto& test) { return "Value" + std::to_string(test.index); });

// A new tool that takes many files must be in the list above.
TEST_F(BatchTest, EveryToolThatTakesManyHasItsValuesChecked) {
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_folder() + "/tools")) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("krok-")) continue;
    const std::string help = get((entry.path() / "README.md").string());
    // A timeline tells all; krok-mix has options of words and paths alone.
    if (help.find("--manifest") == std::string::npos || name == "krok-mix") continue;
    ++found;
    EXPECT_TRUE(std::any_of(values().begin(), values().end(), [&](const Value& value) {
      return value.tool == name;
    })) << name;
  }
  EXPECT_GE(found, 6u);
}

}  // namespace
}  // namespace krok::test
