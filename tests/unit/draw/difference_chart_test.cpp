// If these fail, a chart shows two motions closer or further apart than they are.

#include "draw/difference_chart.h"

#include <gmock/gmock.h>

#include <cmath>

#include "compare/clip_difference.h"
#include "unit/draw/moving_actors.h"

namespace krok::draw {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

TEST(DifferenceChart, AgreesWithTheComparisonOfClips) {
  Clip moved = sliding();
  for (int f = 0; f < moved.frame_count(); ++f) {
    moved.frame_positions(f)[6].x() += 0.005f * static_cast<float>(f);
    moved.frame_orientations(f)[4] =
        moved.frame_orientations(f)[4] * about(krok::Axis::y, 1.0 * f).cast<float>();
  }
  const Shown a(sliding()), b(std::move(moved), "b.bvh");
  const auto difference = difference_over_time(a.charted, b.charted, {});
  ASSERT_TRUE(difference.ok());
  const auto known = compare::difference(a.clip, b.clip, {});
  ASSERT_TRUE(known.ok());
  EXPECT_DOUBLE_EQ(difference->positions.largest, known->positions.largest);
  EXPECT_DOUBLE_EQ(difference->positions.rms(), known->positions.rms());
  EXPECT_DOUBLE_EQ(difference->orientations.rms(), known->orientations.rms());
  EXPECT_THAT(difference->differences, IsEmpty());
  ASSERT_THAT(difference->largest, SizeIs(11));
  EXPECT_NEAR(difference->largest[10], 0.05, 1e-6);
  EXPECT_NEAR(difference->rms[10], 0.05 / std::sqrt(a.clip.joint_count()), 1e-6);
  EXPECT_NEAR(difference->largest_turn[10], 10, 1e-3);
  const auto panels = difference_panels(*difference, Scale::linear);
  EXPECT_EQ(panels[0].y.unit, "mm");
  EXPECT_NEAR(panels[0].series[0].y[10], 50, 1e-3);
}

TEST(DifferenceChart, ComparesMomentsOfDifferentRatesAndOnlyChosenJoints) {
  Clip fast = posed(std::vector<Turns>(21), {}, 20);
  for (Vec3f& place : fast.positions) place.y() += 0.2f;
  const Shown a(posed(std::vector<Turns>(11))), b(std::move(fast), "b.bvh");
  const std::vector<std::string> chosen = {"Head"};
  const auto difference = difference_over_time(a.charted, b.charted, chosen);
  ASSERT_TRUE(difference.ok());
  EXPECT_EQ(difference->joints, 1);
  EXPECT_THAT(difference->times, SizeIs(11));
  EXPECT_THAT(difference->rms, Each(DoubleNear(0.2, 1e-6)));
  EXPECT_THAT(difference->differences, Not(IsEmpty()));  // the rates
  EXPECT_EQ(difference_panels(*difference, Scale::linear)[0].y.unit, "m");
}

TEST(DifferenceChart, ShowsTheToleranceAndTheWorstMoment) {
  ChartedDifference chart;
  chart.title = "Distance between vertices";
  chart.of = "vertices";
  chart.times = {0, 0.5, 1};
  chart.largest = {0, 0.004, 0.002};
  chart.rms = {0, 0.001, 0.001};
  chart.tolerance = 1e-3;
  chart.worst_moment = 0.5;
  const Panel panel = difference_panel(chart, Scale::linear);
  EXPECT_EQ(panel.y.unit, "mm");
  ASSERT_THAT(panel.series, SizeIs(3));
  EXPECT_THAT(panel.series[0].y, ElementsAre(0, 4, 2));
  EXPECT_EQ(panel.series[2].name, "tolerance, 1 mm");
  EXPECT_THAT(panel.series[2].x, ElementsAre(0, 1));
  EXPECT_THAT(panel.series[2].y, ElementsAre(1, 1));
  ASSERT_THAT(panel.moments, SizeIs(1));
  EXPECT_EQ(panel.moments[0].at, 0.5);

  chart.is_angle = true;
  EXPECT_THAT(difference_panel(chart, Scale::linear).series[0].y, ElementsAre(0, 0.004, 0.002));
  chart.times = {0};
  chart.largest = chart.rms = {0.2};
  EXPECT_EQ(difference_panel(chart, Scale::linear).series[0].style, SeriesStyle::line_and_points)
      << "a line of one moment cannot be seen";
}

TEST(DifferenceChart, NeedsSomethingInCommon) {
  Clip other = posed({{}});
  for (std::string& name : other.skeleton.names) name += "_other";
  const Shown a(posed({{}})), b(std::move(other), "b.bvh");
  EXPECT_EQ(difference_over_time(a.charted, b.charted, {}).error().code, "chart-difference");
  Shown c(posed({{}, {}}));
  c.charted.frames = {1, 1};
  EXPECT_EQ(difference_over_time(c.charted, a.charted, {}).error().code, "chart-difference");
}

}  // namespace
}  // namespace krok::draw
