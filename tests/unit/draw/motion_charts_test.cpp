// If these fail, a chart of a motion shows other heights, speeds or places than the motion has, or
// sides and files cannot be told apart.

#include "draw/motion_charts.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "unit/draw/moving_actors.h"
#include "unit/draw/svg_reading.h"

namespace krok::draw {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

std::string svg_of(std::vector<Panel> panels) {
  Chart chart;
  chart.panels = std::move(panels);
  const auto svg = to_svg(chart);
  EXPECT_TRUE(svg.ok());
  return svg.ok() ? *svg : std::string();
}

TEST(MotionCharts, OfAActorWithoutLimbsShowOnlyItsPath) {
  Clip chain;
  chain.skeleton.add("a", -1, {});
  chain.skeleton.add("b", 0, {Vec3(0, 1, 0), Quat::Identity()});
  chain.resize(2);
  for (Quatf& q : chain.orientations) q = Quatf::Identity();
  const Shown shown(std::move(chain));
  EXPECT_THAT(body_angle_panels({&shown.charted, 1}), IsEmpty());
  EXPECT_THAT(foot_panels({&shown.charted, 1}, Scale::linear), IsEmpty());
  EXPECT_THAT(path_panels({&shown.charted, 1}), SizeIs(1));
}

TEST(FootCharts, ShowHeightsAndSpeedsThatTheClipHas) {
  const Shown shown(sliding());
  const auto panels = foot_panels({&shown.charted, 1}, Scale::linear);
  ASSERT_THAT(panels, SizeIs(2));
  const std::string svg = svg_of(panels);
  const std::string heights = panel_text(svg, 0), speeds = panel_text(svg, 1);
  const auto end = static_cast<std::size_t>(shown.clip.skeleton.find("LeftToeBase_end"));
  const Ruler y = y_ruler(heights), x = x_ruler(heights);
  const auto left = line_of(heights, 0);
  ASSERT_GE(left.size(), 8U);
  for (const auto& point : left) {
    const double time = x.value_at(point[0]);
    const auto frame = static_cast<int>(std::lround(time * shown.clip.rate));
    EXPECT_NEAR(time, frame / shown.clip.rate, 0.001);
    EXPECT_NEAR(y.value_at(point[1]), shown.clip.frame_positions(frame)[end].y(), 0.005);
  }
  // 5 cm in a tenth of a second, along the ground.
  EXPECT_THAT(panels[1].series[1].y, Each(DoubleNear(0.5, 1e-4)));
  EXPECT_NEAR(y_ruler(speeds).value_at(line_of(speeds, 1)[0][1]), 0.5, 0.01);
  // At frame 5 the left foot rises by (36 - 16) / 2 cm in a tenth of a second.
  EXPECT_NEAR(panels[1].series[0].y[5], std::hypot(0.5, 1.0), 1e-4);
  EXPECT_THAT(heights, HasSubstr(">height (m)<"));
  EXPECT_THAT(speeds, HasSubstr(">speed (m/s)<"));
  EXPECT_THAT(speeds, HasSubstr(">time (s)<"));
}

TEST(FootCharts, OfOneFrameHaveNoSpeeds) {
  const Shown shown(posed({{}}));
  const auto panels = foot_panels({&shown.charted, 1}, Scale::linear);
  ASSERT_THAT(panels, SizeIs(1));
  EXPECT_THAT(svg_of(panels), Not(HasSubstr("nan")));
}

TEST(FootCharts, DrawContactsInTheColourOfTheirSideAndKeytimesAcross) {
  Shown shown(sliding());
  const int left = shown.clip.skeleton.find("LeftToeBase"),
            right = shown.clip.skeleton.find("RightFoot");
  shown.charted.keys.contacts = {{left, 0.1, 0.35, Vec3(0.1, 0, 0.2)},
                                 {right, 0.4, 0.9, Vec3(-0.1, 0, 0.6)},
                                 {shown.clip.skeleton.find("LeftHand"), 0, 1, Vec3::Zero()}};
  shown.charted.keys.keytimes = {{0.35, "left_off"}, {0.4, "right_strike"}};
  shown.charted.frames = {2, 9};
  const auto panels = foot_panels({&shown.charted, 1}, Scale::linear);
  ASSERT_THAT(panels[0].spans, SizeIs(2));
  EXPECT_THAT(panels[0].lanes, ElementsAre("R", "L"));
  EXPECT_EQ(panels[0].spans[0].lane, 0);
  EXPECT_DOUBLE_EQ(panels[0].spans[0].from, 0.4);
  EXPECT_DOUBLE_EQ(panels[0].spans[0].to, 0.9);
  EXPECT_DOUBLE_EQ(panels[0].spans[1].from, 0.2);  // where what is shown begins
  EXPECT_EQ(panels[0].spans[1].colour, panels[0].series[0].colour);
  EXPECT_EQ(panels[0].spans[0].colour, panels[0].series[1].colour);
  const std::string svg = svg_of(panels);
  EXPECT_EQ(count_of(svg, "class=\"moment\""), 4);
  EXPECT_EQ(count_of(svg, ">right_strike<"), 1);
  // On the map the places of contacts are points.
  const auto path = path_panels({&shown.charted, 1});
  ASSERT_THAT(path[0].series, SizeIs(4));
  EXPECT_THAT(path[0].series[2].x, ElementsAre(0.2));
  EXPECT_THAT(path[0].series[2].y, ElementsAre(0.1));
}

TEST(PathChart, HasZToTheRightAndXUpwards) {
  const Shown shown(sliding());
  const auto panels = path_panels({&shown.charted, 1});
  ASSERT_THAT(panels, SizeIs(1));
  const std::string svg = svg_of(panels);
  const auto line = line_of(svg);
  const Ruler x = x_ruler(svg), y = y_ruler(svg);
  EXPECT_NEAR(x.value_at(line.back()[0]) - x.value_at(line.front()[0]), 0.4, 0.01);
  EXPECT_NEAR(y.value_at(line.back()[1]) - y.value_at(line.front()[1]), 0.3, 0.01);
  EXPECT_LT(line.back()[1], line.front()[1]);
  EXPECT_THAT(svg, HasSubstr(">z (m)<"));
  EXPECT_THAT(svg, HasSubstr("a dot every 0.1 s"));
  EXPECT_EQ(count_of(svg, "<circle"), 11);
}

TEST(MotionCharts, SidesHaveTheSameColoursInAllPanels) {
  const Shown a(sliding()), b(sliding(), "b.bvh");
  std::vector<Panel> panels = body_angle_panels({&a.charted, 1});
  for (Panel& panel : foot_panels({&a.charted, 1}, Scale::linear)) panels.push_back(panel);
  for (const Panel& panel : panels) {
    ASSERT_THAT(panel.series, SizeIs(2)) << panel.title;
    EXPECT_EQ(panel.series[0].colour, panels[0].series[0].colour);
    EXPECT_EQ(panel.series[1].colour, panels[0].series[1].colour);
  }
  const auto legend = motion_legend({&a.charted, 1}, panels);
  ASSERT_THAT(legend, SizeIs(2));
  EXPECT_EQ(legend[0].name, "left");
  EXPECT_EQ(legend[0].colour, panels[0].series[0].colour);
  EXPECT_EQ(legend[1].colour, panels[0].series[1].colour);
}

TEST(MotionCharts, TwoMotionsShareAPanelAndDifferByPattern) {
  const Shown a(sliding()), b(sliding(), "b.bvh");
  const std::vector<ChartedMotion> both = {a.charted, b.charted};
  const auto panels = body_angle_panels(both);
  ASSERT_THAT(panels, SizeIs(5));
  ASSERT_THAT(panels[0].series, SizeIs(4));
  EXPECT_EQ(panels[0].series[0].colour, panels[0].series[2].colour);
  EXPECT_NE(panels[0].series[0].dash, panels[0].series[2].dash);
}

// A mean over other cycles, or stretched otherwise, would show angles that nobody had.
TEST(CycleCharts, AreTheMeanAndDeviationOfCycles) {
  std::vector<Turns> poses;
  for (int f = 0; f <= 20; ++f) poses.push_back({{"LeftLeg", about(krok::Axis::x, 3.0 * f)}});
  Shown shown(posed(poses));
  const double last = shown.charted.clip->duration();
  const std::array<double, 3> strikes = {0, 0.4 * last, last};
  shown.charted.keys.keytimes = {{strikes[0], "left_strike"},
                                 {0.3 * last, "left_off"},
                                 {strikes[1], "left_strike"},
                                 {0.7 * last, "left_off"},
                                 {strikes[2], "left_strike"}};
  const CycleCharts charts = cycle_charts({&shown.charted, 1});
  EXPECT_THAT(charts.counts, ElementsAre(2, 0));
  EXPECT_EQ(charts.motions, 1);
  ASSERT_THAT(charts.panels, SizeIs(5));
  const Panel& knee = charts.panels[1];
  ASSERT_THAT(knee.series, SizeIs(2));  // a band and a line
  const auto angles = body_angle(*shown.charted.clip, *shown.charted.roles, BodyAngle::knee,
                                 Side::left, shown.charted.frames);
  const auto angle_at = [&](double time) {
    const double place = time * shown.charted.clip->rate;
    const auto before = std::min(static_cast<std::size_t>(place), angles.size() - 2);
    const double part = place - static_cast<double>(before);
    return (1 - part) * angles[before] + part * angles[before + 1];
  };
  for (const std::size_t percent : {0U, 25U, 60U, 100U}) {
    const double share = static_cast<double>(percent) / 100;
    const double first = angle_at(strikes[0] + share * (strikes[1] - strikes[0]));
    const double second = angle_at(strikes[1] + share * (strikes[2] - strikes[1]));
    EXPECT_DOUBLE_EQ(knee.series[1].x[percent], static_cast<double>(percent));
    EXPECT_GT(std::abs(first - second), 5) << percent;
    EXPECT_NEAR(knee.series[1].y[percent], (first + second) / 2, 1e-9);
    EXPECT_NEAR(knee.series[0].y[percent],
                (first + second) / 2 + std::abs(first - second) / std::sqrt(2.0), 1e-9);
  }
  ASSERT_THAT(knee.moments, SizeIs(1));
  EXPECT_NEAR(knee.moments[0].at, (75 + 50) / 2.0, 1e-9);
  // Cycles that reach beyond the frames shown do not count.
  shown.charted.frames.last /= 2;
  EXPECT_THAT(cycle_charts({&shown.charted, 1}).counts, ElementsAre(1, 0));
  shown.charted.keys.keytimes.clear();
  EXPECT_THAT(cycle_charts({&shown.charted, 1}).panels, IsEmpty());
}

// A sample in another colour than the line leaves the reader to guess which motion it is.
TEST(MotionCharts, TheLegendHasTheColourAndPatternOfEveryLine) {
  const Shown a(sliding()), b(sliding(), "b.bvh"), c(sliding(), "c.bvh");
  const std::vector<ChartedMotion> all = {a.charted, b.charted, c.charted};
  const std::vector<std::string> joints = {"Head"};
  const auto expect_complete = [&](const std::vector<Panel>& panels) {
    const auto legend = motion_legend(all, panels);
    std::size_t lines = 0;
    for (const Panel& panel : panels) {
      for (const Series& series : panel.series) {
        if (series.name.empty()) continue;
        ++lines;
        const auto same = [&](const LegendEntry& entry) {
          return entry.name == series.name && entry.colour == series.colour &&
                 entry.dash == series.dash;
        };
        EXPECT_EQ(std::count_if(legend.begin(), legend.end(), same), 1)
            << panel.title << " " << series.name;
      }
    }
    EXPECT_GE(lines, legend.size());
    return legend;
  };
  std::vector<Panel> panels = path_panels(all);
  for (const Panel& panel : body_angle_panels(all)) panels.push_back(panel);
  const auto legend = expect_complete(panels);
  ASSERT_THAT(legend, SizeIs(9));
  EXPECT_EQ(legend[3].name, "b.bvh");
  EXPECT_EQ(legend[4].name, "left, b.bvh");
  // Without sided lines there is nothing about sides, without others nothing of the motion alone.
  EXPECT_THAT(expect_complete(position_panels(all, joints)), SizeIs(3));
  EXPECT_THAT(expect_complete(foot_panels(all, Scale::linear)), SizeIs(6));
}

TEST(JointCharts, ShowPositionsOfTheClip) {
  const Shown a(sliding()), b(sliding(), "b.bvh");
  const std::vector<std::string> joints = {"Hips", "Head"};
  const auto one = position_panels({&a.charted, 1}, joints);
  ASSERT_THAT(one, SizeIs(2));
  ASSERT_THAT(one[1].series, SizeIs(3));
  const auto head = static_cast<std::size_t>(a.clip.skeleton.find("Head"));
  for (std::size_t f = 0; f < 11; ++f) {
    EXPECT_EQ(one[1].series[2].y[f], a.clip.frame_positions(static_cast<int>(f))[head].z());
  }
  // Of two motions each axis has a panel with a line for each.
  const std::vector<ChartedMotion> both = {a.charted, b.charted};
  const auto two = position_panels(both, joints);
  ASSERT_THAT(two, SizeIs(6));
  EXPECT_EQ(two[5].title, "Head z");
  EXPECT_EQ(two[5].series[1].y, one[1].series[2].y);
  EXPECT_THAT(turn_panels({&a.charted, 1}, joints), SizeIs(1));
  EXPECT_THAT(turn_panels(both, joints), SizeIs(2));
  EXPECT_EQ(
      euler_panels({&a.charted, 1}, joints, {krok::Axis::z, krok::Axis::x, krok::Axis::y})[0].title,
      "Hips (ZXY Euler)");
}

TEST(JointCharts, TheJointsThatTurnMostAreChosen) {
  const Shown shown(posed({{},
                           {{"LeftArm", about(krok::Axis::x, 60)},
                            {"Head", about(krok::Axis::y, 30)},
                            {"Spine", about(krok::Axis::x, 5)}}}));
  EXPECT_THAT(most_turning_joints(shown.charted, 2), ElementsAre("Head", "LeftArm"));
  EXPECT_THAT(most_turning_joints(shown.charted, 10), ElementsAre("Spine", "Head", "LeftArm"));
  EXPECT_THAT(most_turning_joints(shown.charted, 0), IsEmpty());
}

}  // namespace
}  // namespace krok::draw
