#include "draw/difference_chart.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "compare/matching.h"
#include "core/numbers.h"
#include "draw/chart_style_internal.h"
#include "math/quaternion.h"

namespace krok::draw {

namespace {

struct JointPair {
  int first, second;
};

std::vector<JointPair> common_joints(const Skeleton& first, const Skeleton& second,
                                     std::span<const std::string> joints) {
  const std::unordered_set<std::string> wanted(joints.begin(), joints.end());
  std::unordered_map<std::string_view, int> second_joints;
  for (int j = 0; j < second.joint_count(); ++j) {
    second_joints.emplace(second.names[static_cast<std::size_t>(j)], j);
  }
  std::vector<JointPair> pairs;
  for (int j = 0; j < first.joint_count(); ++j) {
    const std::string& name = first.names[static_cast<std::size_t>(j)];
    if (!wanted.empty() && wanted.count(name) == 0) continue;
    if (const auto other = second_joints.find(name); other != second_joints.end()) {
      pairs.push_back({j, other->second});
    }
  }
  return pairs;
}

// The max and the RMS of one frame's differences.
class FrameMeasure {
 public:
  void add(double value) {
    largest_ = std::max(largest_, value);
    squares_ += value * value;
    ++count_;
  }
  double largest() const { return largest_; }
  double rms() const { return count_ > 0 ? std::sqrt(squares_ / count_) : 0; }

 private:
  double largest_ = 0, squares_ = 0;
  int count_ = 0;
};

void add_frame(const ChartedMotion& first, const ChartedMotion& second,
               const std::vector<JointPair>& joints, const std::pair<int, int>& frames,
               MotionDifference& result) {
  const auto places_a = first.clip->frame_positions(frames.first);
  const auto places_b = second.clip->frame_positions(frames.second);
  const auto turns_a = first.clip->frame_orientations(frames.first);
  const auto turns_b = second.clip->frame_orientations(frames.second);
  const double time = frames.first / first.clip->rate;
  FrameMeasure lengths, angles;
  for (const JointPair& pair : joints) {
    const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
    const double length = (places_a[a].cast<double>() - places_b[b].cast<double>()).norm();
    const double angle = angle_between(turns_a[a].cast<double>().normalized(),
                                       turns_b[b].cast<double>().normalized());
    const compare::ValueLocation place{.joint = pair.first, .frame = frames.first, .time = time};
    result.positions.add(length, place);
    result.orientations.add(angle, place);
    lengths.add(length);
    angles.add(angle / kRadiansPerDegree);
  }
  result.times.push_back(time);
  result.largest.push_back(lengths.largest());
  result.rms.push_back(lengths.rms());
  result.largest_turn.push_back(angles.largest());
  result.rms_turn.push_back(angles.rms());
}

}  // namespace

Result<MotionDifference> difference_over_time(const ChartedMotion& first,
                                              const ChartedMotion& second,
                                              std::span<const std::string> joints) {
  const Skeleton& skeleton = first.clip->skeleton;
  const auto pairs = common_joints(skeleton, second.clip->skeleton, joints);
  if (pairs.empty()) {
    return Error(
        "chart-difference",
        joints.empty() ? "the two motions have no joints with the same name"
                       : "none of the chosen joints is in both motions",
        "krok-info lists the joints; krok-retarget transfers a motion to another skeleton");
  }
  MotionDifference result;
  result.joints = static_cast<int>(pairs.size());
  auto skeletons = compare::match_skeletons(skeleton, second.clip->skeleton);
  if (!skeletons.difference.empty()) result.differences.push_back(std::move(skeletons.difference));
  auto match = compare::match_frames(first.clip->frame_count(), first.clip->rate,
                                     second.clip->frame_count(), second.clip->rate);
  for (std::string& sentence : match.differences) result.differences.push_back(std::move(sentence));
  for (const auto& frames : match.frames) {
    if (frames.first < first.frames.first || frames.first > first.frames.last) continue;
    add_frame(first, second, pairs, frames, result);
  }
  if (result.times.empty()) {
    return Error("chart-difference", "the two motions do not overlap in time");
  }
  return result;
}

Panel difference_panel(const ChartedDifference& difference, Scale scale) {
  double most = 0;
  for (const double value : difference.largest) most = std::max(most, value);
  const bool small = !difference.is_angle && most < 0.1;
  const double unit = small ? 1000 : 1;
  const char* const name = difference.is_angle ? "\u00B0" : small ? "mm" : "m";
  const auto in_unit = [unit](std::vector<double> values) {
    for (double& value : values) value *= unit;
    return values;
  };
  const SeriesStyle style =
      difference.times.size() == 1 ? SeriesStyle::line_and_points : SeriesStyle::line;
  Panel panel;
  panel.title = difference.title;
  panel.x = {"time", "s"};
  panel.y = {difference.is_angle ? "angle" : "distance", name, scale};
  if (scale == Scale::linear) panel.y.low = 0;
  const int black = motion_colour(0), blue = kLeftColour, orange = kRightColour;
  panel.series.push_back({"largest of all " + difference.of, difference.times,
                          in_unit(difference.largest), style, black, 0});
  panel.series.push_back(
      {"root mean square", difference.times, in_unit(difference.rms), style, blue, 1});
  if (difference.tolerance && !difference.times.empty()) {
    const double level = *difference.tolerance * unit;
    const std::string label = readable(level, 4) + (difference.is_angle ? "" : " ") + name;
    panel.series.push_back({"tolerance, " + label,
                            {difference.times.front(), difference.times.back()},
                            {level, level},
                            SeriesStyle::line,
                            orange,
                            2});
  }
  if (difference.worst_moment) {
    panel.moments.push_back(
        {*difference.worst_moment, "largest, " + readable(*difference.worst_moment, 4) + " s"});
  }
  return panel;
}

std::array<ChartedDifference, 2> difference_charts(const MotionDifference& difference) {
  ChartedDifference distances, angles;
  distances.title = "Distance between joints";
  angles.title = "Angle between joints";
  angles.is_angle = true;
  for (ChartedDifference* chart : {&distances, &angles}) {
    chart->of = "joints";
    chart->times = difference.times;
  }
  distances.largest = difference.largest;
  distances.rms = difference.rms;
  angles.largest = difference.largest_turn;
  angles.rms = difference.rms_turn;
  return {std::move(distances), std::move(angles)};
}

std::vector<Panel> difference_panels(const MotionDifference& difference, Scale scale) {
  std::vector<Panel> panels;
  for (const ChartedDifference& chart : difference_charts(difference)) {
    panels.push_back(difference_panel(chart, scale));
  }
  return panels;
}

}  // namespace krok::draw
