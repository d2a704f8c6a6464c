// If these fail, krok-view or krok-plot draws a ground or footprints that are not those of the
// files, or ends otherwise than krok-walk on files that are wrong.

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/krok_view/shown_page.h"
#include "cli/step_library/library_fixture.h"

namespace krok::test {
namespace {

class WalkOnGround : public StepLibrary {
 protected:
  void SetUp() override {
    StepLibrary::SetUp();
    fit_well();
    const ToolRun made =
        run_tool("krok-walk",
                 {path("out.steps"), "--goal", "0m,3m", "--ground", kStairs, "-q", "--save-prints",
                  path("prints.csv"), "-o", path("walk.anim"), "--save-page", path("walk.html")});
    ASSERT_EQ(made.exit_code, 0) << made.err;
  }
  ToolRun view(std::vector<std::string> more) const {
    more.insert(more.begin(), {path("walk.anim"), "--body", "none", "-o", path("out.html")});
    return run_tool("krok-view", more);
  }
  ToolRun plot(std::vector<std::string> more) const {
    more.insert(more.begin(), {path("walk.anim"), "-o", path("out.svg")});
    return run_tool("krok-plot", more);
  }
  nlohmann::json data() const { return data_of(get(path("out.html"))); }
  // Corners of the ground's triangles, as the page has them.
  std::vector<float> ground_positions() const {
    const std::string bytes = bytes_of_base64(element_of(get(path("out.html")), "krok-ground"));
    const nlohmann::json place = data()["ground"]["positions"];
    std::vector<float> numbers(place["count"].get<std::size_t>());
    std::memcpy(numbers.data(), bytes.data() + place["offset"].get<std::size_t>(),
                4 * numbers.size());
    return numbers;
  }

  static constexpr const char* kStairs = "stairs:rise=8cm,run=40cm,count=5";
};

TEST_F(WalkOnGround, IsOnThePage) {
  const ToolRun made = view({"--ground", kStairs, "--prints", path("prints.csv"), "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto report = nlohmann::json::parse(made.out)["result"];
  const nlohmann::json page = data();
  const nlohmann::json& prints = page["prints"]["list"];
  EXPECT_EQ(report["prints"], prints.size());
  EXPECT_EQ(report["ground_triangles"], page["ground"]["triangles"]["count"].get<int>() / 3);
  // Soles are measured on the motion, which has been rounded to floats here and not there.
  nlohmann::json walked = data_of(get(path("walk.html")))["prints"]["list"];
  ASSERT_EQ(walked.size(), prints.size());
  for (std::size_t i = 0; i < prints.size(); ++i) {
    EXPECT_NEAR(walked[i]["length"], prints[i]["length"], 1e-6);
    walked[i]["length"] = prints[i]["length"];
  }
  EXPECT_EQ(prints, walked);
  ASSERT_GT(prints.size(), 6U);
  for (std::size_t i = 0; i < prints.size(); ++i) {
    EXPECT_EQ(prints[i]["number"], i + 1);
    const double z = prints[i]["heel"][2];
    EXPECT_NEAR(prints[i]["heel"][1].get<double>(),
                0.08 * std::clamp(std::floor((z - 1) / 0.4) + 1, 0.0, 5.0), 1e-4);
  }
  // Each print is stood on once, in order, and two at a time at most.
  const nlohmann::json& contacts = page["items"][0]["printContacts"];
  ASSERT_EQ(contacts.size(), prints.size());
  for (std::size_t i = 2; i < contacts.size(); ++i) {
    EXPECT_EQ(contacts[i][0], i);
    EXPECT_GT(contacts[i][1], contacts[i - 2][2]);
  }
  // All five treads and the ground before them, and nothing in between.
  std::set<int> heights;
  const std::vector<float> positions = ground_positions();
  for (std::size_t i = 1; i < positions.size(); i += 3) {
    heights.insert(static_cast<int>(std::lround(1000 * positions[i])));
  }
  EXPECT_EQ(heights, (std::set<int>{0, 80, 160, 240, 320, 400}));
}

TEST_F(WalkOnGround, WithoutAGroundThePrintsAreLevel) {
  ASSERT_EQ(view({"--prints", path("prints.csv")}).exit_code, 0);
  const nlohmann::json page = data();
  EXPECT_FALSE(page.contains("ground"));
  for (const nlohmann::json& print : page["prints"]["list"]) EXPECT_EQ(print["heel"][1], 0);
  // The feet, which climb, stand on the first ones alone.
  EXPECT_LT(page["items"][0]["printContacts"].size(), page["prints"]["list"].size());
  ASSERT_EQ(view({}).exit_code, 0);
  EXPECT_FALSE(data().contains("prints"));
}

TEST_F(WalkOnGround, IsInTheCharts) {
  const ToolRun walked =
      run_tool("krok-walk", {path("out.steps"), "--goal", "0m,3m", "--ground", "slope:6deg", "-q",
                             "--save-prints", path("prints.csv"), "-o", path("walk.anim")});
  ASSERT_EQ(walked.exit_code, 0) << walked.err;
  const ToolRun made = plot(
      {"--show", "path,feet", "--ground", "slope:6deg", "--prints", path("prints.csv"), "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto panels = nlohmann::json::parse(made.out)["result"]["panels"];
  EXPECT_EQ(panels[0]["title"], "From above; ground in m");
  EXPECT_EQ(panels[1]["title"], "Height of the soles over the ground");
  ASSERT_EQ(panels[1]["lines"].size(), 2U);
  for (const nlohmann::json& line : panels[1]["lines"]) {
    // On the ground, never in it, and lifted for each step.
    EXPECT_NEAR(line["smallest"].get<double>(), 0, 0.002);
    EXPECT_GT(line["largest"], 0.02);
    EXPECT_LT(line["largest"], 0.2);
  }
  const std::string svg = get(path("out.svg"));
  for (const char* number : {">1</text>", ">5</text>"}) EXPECT_THAT(svg, HasSubstr(number));
  // Over the level they are as high as the slope.
  const ToolRun level = plot({"--show", "feet", "--ground", "level", "--json"});
  const auto high = nlohmann::json::parse(level.out)["result"]["panels"][0]["lines"];
  EXPECT_GT(high[0]["largest"], 0.2);
}

TEST_F(WalkOnGround, WrongFilesAreErrorsAsInKrokWalk) {
  const std::string head = "side,x,z,heading\n";
  write("two.csv", head + "left,0.1,0,0\nleft,-0.1,0,0\n");
  write("nan.csv", head + "left,0.1,0,0\nright,nan,0,0\n");
  write("none.csv", head);
  write("none.json", R"({"schema": "krok.prints/1", "prints": []})");
  write("gap.csv", head + "left,0.1,0,0\nright,-0.1,1.5,0\n");
  write("gap.obj", "v -2 0 -2\nv 2 0 -2\nv 2 0 1\nv -2 0 1\nf 4 3 2 1\n");
  const auto refused = [&](const std::string& prints, const std::string& ground,
                           const std::string& says) {
    for (const ToolRun& run : {view({"--prints", path(prints), "--ground", ground}),
                               plot({"--prints", path(prints), "--ground", ground})}) {
      EXPECT_EQ(run.exit_code, 2) << prints;
      EXPECT_THAT(run.err, HasSubstr(says));
    }
  };
  refused("two.csv", "level", "two.csv:3:1: error: ");
  refused("nan.csv", "level", "nan.csv:3:7: error: ");
  refused("none.csv", "level", "[csv-empty]");
  refused("none.json", "level", "[prints-empty]");
  refused("gap.csv", path("gap.obj"), "gap.csv: error: print 2: there is no ground");
  refused("prints.csv", "stair", "[ground-kind]");
  refused("prints.csv", path("missing.obj"), "[file-missing]");
  EXPECT_THAT(listing(), Not(Contains("out.html")));
  EXPECT_THAT(listing(), Not(Contains("out.svg")));
  EXPECT_THAT(view({"--ground", "level", "--layout", "apart"}).err, HasSubstr("[usage]"));
}

// Would fail if a long file of footprints made a page that no browser shows.
TEST_F(WalkOnGround, ThousandsOfPrintsAreThoseNearTheMotion) {
  std::string many = "side,x,z,heading\n";
  for (int i = 0; i < 100'000; ++i) {
    many += (i % 2 == 0 ? "left,0.1," : "right,-0.1,") + std::to_string(0.3 * i) + ",0\n";
  }
  write("many.csv", many);
  const ToolRun run = view({"--prints", path("many.csv")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("[prints-many]"));
  const std::size_t shown = data()["prints"]["list"].size();
  EXPECT_GT(shown, 40U);
  EXPECT_LT(shown, 60U);
  write("one.csv", "side,x,z,heading\nleft,0.1,0,0\n");
  EXPECT_EQ(view({"--prints", path("one.csv")}).exit_code, 0);
  EXPECT_EQ(data()["prints"]["list"].size(), 1U);
}

}  // namespace
}  // namespace krok::test
