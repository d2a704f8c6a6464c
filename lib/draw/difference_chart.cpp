#include "draw/difference_chart.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "compare/frame_match.h"
#include "compare/skeleton_match.h"
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

// The largest of one frame's differences and the root of their mean square.
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
    const compare::Place place{.joint = pair.first, .frame = frames.first, .time = time};
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

Panel panel_of(const std::vector<double>& times, std::string title, Axis axis, Scale scale,
               std::vector<double> largest, std::vector<double> rms) {
  Panel panel;
  panel.title = std::move(title);
  panel.x = {"time", "s"};
  panel.y = std::move(axis);
  panel.y.scale = scale;
  if (scale == Scale::linear) panel.y.low = 0;
  const int black = motion_colour(0), blue = kLeftColour;
  panel.series.push_back({"largest of all joints", times, std::move(largest), {}, black, 0});
  panel.series.push_back({"root mean square", times, std::move(rms), {}, blue, 1});
  return panel;
}

}  // namespace

Result<MotionDifference> difference_over_time(const ChartedMotion& first,
                                              const ChartedMotion& second,
                                              std::span<const std::string> joints) {
  const Skeleton& skeleton = first.clip->skeleton;
  const auto pairs = common_joints(skeleton, second.clip->skeleton, joints);
  if (pairs.empty()) {
    return Error("chart-difference",
                 joints.empty() ? "the two motions have no joint of the same name"
                                : "the two motions have none of the chosen joints in common",
                 "krok-info lists the joints; krok-retarget brings a motion onto another skeleton");
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
    return Error("chart-difference", "the two motions have no moment in common");
  }
  return result;
}

std::vector<Panel> difference_panels(const MotionDifference& difference, Scale scale) {
  const bool small = difference.positions.largest < 0.1;
  std::vector<double> largest = difference.largest, rms = difference.rms;
  if (small) {
    for (auto* values : {&largest, &rms}) {
      for (double& value : *values) value *= 1000;
    }
  }
  return {panel_of(difference.times, "Distance between joints", {"distance", small ? "mm" : "m"},
                   scale, std::move(largest), std::move(rms)),
          panel_of(difference.times, "Angle between joints", {"angle", "\u00B0"}, scale,
                   difference.largest_turn, difference.rms_turn)};
}

}  // namespace krok::draw
