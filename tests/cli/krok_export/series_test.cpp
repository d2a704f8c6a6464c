// krok-export --what. Would fail if a table held other values than the motion or than krok-plot
// draws, or if OpenSim's header did not fit its rows.
#include <cmath>
#include <sstream>

#include "cli/motion_fixture.h"

namespace krok::test {
namespace {

using Rows = std::vector<std::vector<std::string>>;

class ExportSeries : public MotionTest {
 protected:
  ExportSeries() : walk_(write_walk(4)) {}

  Rows rows(const std::string& name, char between = ',') const {
    Rows result;
    std::istringstream lines(get(path(name)));
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> fields;
      std::istringstream parts(line);
      for (std::string field; std::getline(parts, field, between);) fields.push_back(field);
      result.push_back(fields);
    }
    return result;
  }

  Rows exported(std::vector<std::string> options) const {
    options.insert(options.begin(), {"walk.anim", "-o", "t.csv"});
    const ToolRun run = run_here("krok-export", options);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return rows("t.csv");
  }

  Clip walk_;
};

TEST_F(ExportSeries, LongAndWideHoldTheSamePositions) {
  const Rows all = exported({});
  EXPECT_EQ(exported({"--what", "positions", "--layout", "long"}), all);
  const Rows wide = exported({"--layout", "wide"});
  const auto joints = static_cast<std::size_t>(walk_.joint_count());
  ASSERT_EQ(wide.size(), static_cast<std::size_t>(walk_.frame_count()) + 1);
  ASSERT_EQ(wide[0].size(), 2 + 3 * joints);
  EXPECT_EQ(wide[0][2], walk_.skeleton.names[0] + ".x");
  for (std::size_t f : {std::size_t{0}, wide.size() - 2}) {
    for (std::size_t j = 0; j < joints; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(wide[1 + f][2 + 3 * j + k], all[1 + f * joints + j][3 + k]);
      }
    }
  }
}

TEST_F(ExportSeries, VelocitiesAreCentralDifferencesOfPositions) {
  const Rows wide = exported({"--what", "velocities", "--layout", "wide"});
  const int middle = walk_.frame_count() / 2;
  for (int j = 0; j < walk_.joint_count(); ++j) {
    const Vec3 way = (walk_.frame_positions(middle + 1)[static_cast<std::size_t>(j)] -
                      walk_.frame_positions(middle - 1)[static_cast<std::size_t>(j)])
                         .cast<double>() *
                     walk_.rate / 2;
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(
          std::stod(
              wide[static_cast<std::size_t>(middle) + 1][static_cast<std::size_t>(2 + 3 * j + k)]),
          way[k], 1e-4);
    }
  }
}

// Would fail if values were lost, or signs changed, where one block of frames follows another.
TEST_F(ExportSeries, LongTablesGoOn) {
  put("t.bvh", capture(9000));
  const auto table = [&](const char* what) {
    const ToolRun run =
        run_here("krok-export", {"t.bvh", "--what", what, "--layout", "wide", "-o", "t.csv"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return rows("t.csv");
  };
  const Rows places = table("positions"), velocities = table("velocities");
  const Rows turns = table("quaternions");
  ASSERT_EQ(velocities.size(), 9001U);
  for (std::size_t f = 1; f + 1 < 9000; ++f) {
    ASSERT_EQ(velocities[f + 1][0], std::to_string(f));
    for (std::size_t c = 2; c < places[0].size(); ++c) {
      const double way = std::stod(places[f + 2][c]) - std::stod(places[f][c]);
      ASSERT_NEAR(std::stod(velocities[f + 1][c]), 15 * way, 2e-4) << f;
    }
    for (std::size_t j = 2; j < turns[0].size(); j += 4) {
      double dot = 0;
      for (std::size_t k = j; k < j + 4; ++k) {
        dot += std::stod(turns[f][k]) * std::stod(turns[f + 1][k]);
      }
      ASSERT_GE(dot, 0) << f;
    }
  }
}

// Walking down the tree with them gives the motion again.
TEST_F(ExportSeries, LocalPlacesAndQuaternionsComposeToTheMotion) {
  const Rows local = exported({"--what", "local"});
  const Rows world = exported({"--what", "quaternions"});
  const auto joints = static_cast<std::size_t>(walk_.joint_count());
  const std::size_t frame = 37;
  std::vector<Transform> at;
  for (std::size_t j = 0; j < joints; ++j) {
    const auto& row = local[1 + frame * joints + j];
    const auto number = [&](std::size_t i) { return std::stod(row[i]); };
    Transform here{Vec3(number(3), number(4), number(5)),
                   Quat(number(9), number(6), number(7), number(8))};
    const int parent = walk_.skeleton.parents[j];
    if (parent >= 0) here = at[static_cast<std::size_t>(parent)] * here;
    at.push_back(here);
    const Vec3 place = walk_.frame_positions(static_cast<int>(frame))[j].cast<double>();
    EXPECT_LT((here.position - place).norm(), 1e-5) << j;
    const auto& q = world[1 + frame * joints + j];
    const Quat read(std::stod(q[6]), std::stod(q[3]), std::stod(q[4]), std::stod(q[5]));
    EXPECT_GT(std::abs(read.dot(here.orientation)), 1 - 1e-6) << j;
  }
}

TEST_F(ExportSeries, AnglesAreThoseThatKrokPlotDraws) {
  const Rows wide = exported({"--what", "angles", "--layout", "wide"});
  const json report = report_here("krok-plot", {"walk.anim", "--show", "angles", "-o", "a.svg"});
  const std::vector<std::pair<std::string, std::string>> names = {
      {"Hip flexion", "hip_flexion"},
      {"Knee flexion", "knee_flexion"},
      {"Ankle dorsiflexion", "ankle_dorsiflexion"},
      {"Shoulder elevation", "shoulder_elevation"},
      {"Elbow flexion", "elbow_flexion"}};
  int compared = 0;
  for (const json& panel : report["result"]["panels"]) {
    for (const auto& [title, name] : names) {
      if (panel["title"] != title) continue;
      ASSERT_EQ(panel["lines"].size(), 2U);
      for (std::size_t side = 0; side < 2; ++side) {
        const std::string column = name + (side == 0 ? "_l" : "_r");
        const auto at = std::ranges::find(wide[0], column) - wide[0].begin();
        ASSERT_LT(static_cast<std::size_t>(at), wide[0].size()) << column;
        double low = 1e9, high = -1e9, sum = 0;
        for (std::size_t r = 1; r < wide.size(); ++r) {
          const double value = std::stod(wide[r][static_cast<std::size_t>(at)]);
          low = std::min(low, value);
          high = std::max(high, value);
          sum += value;
        }
        const json& line = panel["lines"][side];
        EXPECT_NEAR(line["smallest"].get<double>(), low, 1e-4) << column;
        EXPECT_NEAR(line["largest"].get<double>(), high, 1e-4) << column;
        EXPECT_NEAR(line["mean"].get<double>(), sum / static_cast<double>(wide.size() - 1), 1e-4);
        EXPECT_EQ(line["unit"], "\u00B0");
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 10);
}

TEST_F(ExportSeries, OpenSimsFilesOfLengthsAreNotInDegrees) {
  ASSERT_EQ(run_here("krok-export", {"walk.anim", "--what", "positions", "-o", "p.sto"}).exit_code,
            0);
  EXPECT_EQ(rows("p.sto", '\t')[4][0], "inDegrees=no");
}

TEST_F(ExportSeries, OpenSimsFilesHaveTheAnglesUnderItsCoordinates) {
  ASSERT_EQ(run_here("krok-export", {"walk.anim", "-o", "walk.mot"}).exit_code, 0);
  const Rows lines = rows("walk.mot", '\t');
  EXPECT_EQ(lines[0][0], "walk");
  EXPECT_EQ(lines[2][0], "nRows=" + std::to_string(walk_.frame_count()));
  EXPECT_EQ(lines[4][0], "inDegrees=yes");
  EXPECT_EQ(lines[5][0], "endheader");
  EXPECT_EQ(lines[3][0], "nColumns=" + std::to_string(lines[6].size()));
  ASSERT_EQ(lines.size(), 7 + static_cast<std::size_t>(walk_.frame_count()));
  for (std::size_t r = 7; r < lines.size(); ++r) EXPECT_EQ(lines[r].size(), lines[6].size());
  EXPECT_THAT(lines[6], Contains("knee_angle_r"));
  const Rows wide = exported({"--what", "angles", "--layout", "wide"});
  const auto knee = std::ranges::find(wide[0], "knee_flexion_r") - wide[0].begin();
  const auto angle = std::ranges::find(lines[6], "knee_angle_r") - lines[6].begin();
  EXPECT_EQ(lines[40][static_cast<std::size_t>(angle)], wide[34][static_cast<std::size_t>(knee)]);
}

TEST_F(ExportSeries, ContactsAreARowEachOrAColumnEach) {
  const Rows each = exported({"--what", "contacts"});
  EXPECT_EQ(each[0], (std::vector<std::string>{"joint", "start", "end", "x", "y", "z"}));
  ASSERT_GT(each.size(), 4U);
  const Rows wide = exported({"--what", "contacts", "--layout", "wide"});
  const auto column = std::ranges::find(wide[0], each[1][0]) - wide[0].begin();
  for (std::size_t r = 1; r < wide.size(); ++r) {
    const double time = std::stod(wide[r][1]);
    bool down = false;
    for (std::size_t c = 1; c < each.size(); ++c) {
      down = down || (each[c][0] == each[1][0] && std::stod(each[c][1]) <= time &&
                      time <= std::stod(each[c][2]));
    }
    EXPECT_EQ(wide[r][static_cast<std::size_t>(column)], down ? "1" : "0") << time;
  }
}

// If this fails, a table of a folder is refused, mixes up or loses motions, or is not the rows of
// the single tables with the file in front.
TEST_F(ExportSeries, AFolderIsOneTableWithTheFileInFront) {
  std::filesystem::create_directories(path("takes"));
  std::filesystem::copy_file(path("walk.anim"), path("takes/a.anim"));
  put("takes/broken.bvh", "HIERARCHY\n");
  const ToolRun one = run_here("krok-export", {"takes", "-o", "all.csv"});
  EXPECT_EQ(one.exit_code, 3) << one.err;
  EXPECT_EQ(rows("all.csv").at(1).at(0), "takes/a.anim") << "a column also of a single motion";
  std::filesystem::rename(path("takes/broken.bvh"), path("broken.bvh"));
  std::filesystem::copy_file(path("walk.anim"), path("takes/b.anim"));
  for (const std::string what : {"positions", "contacts", "angles"}) {
    for (const std::string layout : {"long", "wide"}) {
      const Rows single = exported({"--what", what, "--layout", layout});
      const ToolRun run =
          run_here("krok-export", {"takes", "--what", what, "--layout", layout, "-o", "all.csv"});
      ASSERT_EQ(run.exit_code, 0) << run.err;
      Rows expected = {single[0]};
      expected[0].insert(expected[0].begin(), "file");
      for (const std::string file : {"takes/a.anim", "takes/b.anim"}) {
        for (std::size_t r = 1; r < single.size(); ++r) {
          expected.push_back(single[r]);
          expected.back().insert(expected.back().begin(), file);
        }
      }
      EXPECT_EQ(rows("all.csv"), expected) << what << ' ' << layout;
    }
  }
  put("takes/chain.bvh", capture(5));
  const ToolRun wide = run_here("krok-export", {"takes", "--layout", "wide", "-o", "all.csv"});
  EXPECT_EQ(wide.exit_code, 2);
  EXPECT_TRUE(has_code(wide.err, "export-columns")) << wide.err;
  const ToolRun glb = run_here("krok-export", {"takes", "-o", "all.glb"});
  EXPECT_EQ(glb.exit_code, 2);
  EXPECT_THAT(glb.err, testing::HasSubstr("--out-dir"));
}

TEST_F(ExportSeries, OptionsOfTablesAreForTables) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"-o", "x.glb", "--what", "angles"},
        {"-o", "x.bvh", "--layout", "wide"},
        {"-o", "x.mot", "--layout", "wide"},
        {"-o", "x.csv", "--what", "forces"}}) {
    std::vector<std::string> all = {"walk.anim"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const ToolRun run = run_here("krok-export", all);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_TRUE(has_code(run.err, "usage")) << run.err;
  }
  put("chain.bvh", capture(5));
  const ToolRun run = run_here("krok-export", {"chain.bvh", "--what", "angles", "-o", "x.csv"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has_code(run.err, "export-angles")) << run.err;
}

}  // namespace
}  // namespace krok::test
