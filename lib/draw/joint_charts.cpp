#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>

#include "draw/chart_style_internal.h"

namespace krok::draw {

namespace {

struct BodyAngleName {
  BodyAngle angle;
  const char* title;
  bool of_leg;
};
constexpr std::array kBodyAngles = {BodyAngleName{BodyAngle::hip, "Hip flexion", true},
                                    BodyAngleName{BodyAngle::knee, "Knee flexion", true},
                                    BodyAngleName{BodyAngle::ankle, "Ankle dorsiflexion", true},
                                    BodyAngleName{BodyAngle::shoulder, "Shoulder elevation", false},
                                    BodyAngleName{BodyAngle::elbow, "Elbow flexion", false}};

constexpr const char* kDegrees = "\u00B0";
constexpr std::array<std::string_view, 3> kAxisNames = {"x", "y", "z"};
// Red, green and blue, as is usual for x, y and z.
constexpr std::array kAxisColours = {1, 2, 0};

// Three curves of a joint, [3][frames].
using ThreeCurves =
    std::function<std::vector<std::vector<double>>(const ChartedMotion& motion, int joint)>;

// Labels of the three curves of a joint.
struct CurveNames {
  std::string title;  // after the joint's name
  std::string label, unit;
  std::array<std::size_t, 3> axes;
};

// For one motion, a panel per joint; for several, a panel per joint and curve.
std::vector<Panel> three_curve_panels(std::span<const ChartedMotion> motions,
                                      std::span<const std::string> joints, const CurveNames& names,
                                      const ThreeCurves& curves_of) {
  const bool apart = motions.size() > 1;
  std::vector<Panel> panels;
  for (const std::string& joint : joints) {
    std::vector<Panel> of_joint;
    for (std::size_t k = 0; k < (apart ? 3U : 1U); ++k) {
      const std::string axis =
          apart ? fmt::format(" {}", kAxisNames[names.axes[k]]) : std::string();
      of_joint.push_back(time_panel(motions, fmt::format("{}{}{}", joint, names.title, axis),
                                    names.label, names.unit));
    }
    for (std::size_t m = 0; m < motions.size(); ++m) {
      const int index = motions[m].clip->skeleton.find(joint);
      if (index < 0) continue;
      auto curves = curves_of(motions[m], index);
      for (std::size_t k = 0; k < 3; ++k) {
        Series line = motion_line(motions[m], m, std::move(curves[k]));
        if (!apart) {
          of_joint[0].legend = true;
          line.name = kAxisNames[names.axes[k]];
          line.colour = kAxisColours[names.axes[k]];
          line.dash = static_cast<int>(k);
        }
        of_joint[apart ? k : 0].series.push_back(std::move(line));
      }
    }
    panels.insert(panels.end(), of_joint.begin(), of_joint.end());
  }
  return panels;
}

}  // namespace

std::vector<Panel> body_angle_panels(std::span<const ChartedMotion> motions) {
  std::vector<Panel> panels;
  for (const BodyAngleName& name : kBodyAngles) {
    Panel panel = time_panel(motions, name.title, "angle", kDegrees);
    for (std::size_t m = 0; m < motions.size(); ++m) {
      for (const Side side : {Side::left, Side::right}) {
        auto values =
            body_angle(*motions[m].clip, *motions[m].roles, name.angle, side, motions[m].frames);
        if (values.empty()) continue;
        panel.series.push_back(side_line(motions[m], m, side, std::move(values)));
      }
    }
    if (panel.series.empty()) continue;
    if (name.of_leg) add_keys(motions, false, panel);
    panels.push_back(std::move(panel));
  }
  return panels;
}

std::vector<Panel> position_panels(std::span<const ChartedMotion> motions,
                                   std::span<const std::string> joints) {
  const CurveNames names = {"", "position", "m", {0, 1, 2}};
  return three_curve_panels(motions, joints, names, [](const ChartedMotion& motion, int joint) {
    std::vector<std::vector<double>> curves(3);
    for (int f = motion.frames.first; f <= motion.frames.last; ++f) {
      const Vec3f& place = motion.clip->frame_positions(f)[static_cast<std::size_t>(joint)];
      for (int axis = 0; axis < 3; ++axis) {
        curves[static_cast<std::size_t>(axis)].push_back(place[axis]);
      }
    }
    return curves;
  });
}

std::vector<Panel> euler_panels(std::span<const ChartedMotion> motions,
                                std::span<const std::string> joints, const EulerOrder& order) {
  CurveNames names = {" (", "angle", kDegrees, {}};
  for (std::size_t k = 0; k < 3; ++k) {
    names.axes[k] = static_cast<std::size_t>(order[k]);
    names.title += static_cast<char>('X' + static_cast<int>(order[k]));
  }
  names.title += " Euler)";
  return three_curve_panels(motions, joints, names,
                            [&order](const ChartedMotion& motion, int joint) {
                              return euler_angles(*motion.clip, joint, order, motion.frames);
                            });
}

std::vector<Panel> turn_panels(std::span<const ChartedMotion> motions,
                               std::span<const std::string> joints) {
  const bool apart = motions.size() > 1;
  std::vector<Panel> panels;
  if (!apart && !joints.empty()) {
    panels.push_back(time_panel(motions, "Rotation from the reference pose", "angle", kDegrees));
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (apart) {
      panels.push_back(time_panel(motions,
                                  fmt::format("{}: rotation from the reference pose", joints[j]),
                                  "angle", kDegrees));
    }
    for (std::size_t m = 0; m < motions.size(); ++m) {
      const int index = motions[m].clip->skeleton.find(joints[j]);
      if (index < 0) continue;
      Series line =
          motion_line(motions[m], m, turn_angle(*motions[m].clip, index, motions[m].frames));
      if (!apart) {
        panels.back().legend = true;
        line.name = joints[j];
        line.colour = line.dash = static_cast<int>(j);
      }
      panels.back().series.push_back(std::move(line));
    }
  }
  return panels;
}

std::vector<std::string> most_turning_joints(const ChartedMotion& motion, int count) {
  constexpr double kMin = 0.5;  // degrees
  const Skeleton& skeleton = motion.clip->skeleton;
  std::vector<std::pair<double, int>> turns;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (skeleton.end_sites[static_cast<std::size_t>(j)] != 0) continue;
    const auto angles = turn_angle(*motion.clip, j, motion.frames);
    if (angles.empty()) continue;
    const auto [low, high] = std::minmax_element(angles.begin(), angles.end());
    if (*high - *low >= kMin) turns.emplace_back(*high - *low, j);
  }
  const auto kept = std::min(turns.size(), static_cast<std::size_t>(std::max(count, 0)));
  std::stable_sort(turns.begin(), turns.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  turns.resize(kept);
  std::sort(turns.begin(), turns.end(),
            [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<std::string> names;
  for (const auto& turn : turns) {
    names.push_back(skeleton.names[static_cast<std::size_t>(turn.second)]);
  }
  return names;
}

}  // namespace krok::draw
