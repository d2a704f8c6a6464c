#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>

#include "contacts/gait_metrics.h"
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

constexpr int kParts = 100;  // of a cycle

// The values of a curve over a cycle, [kParts + 1], linear between frames; empty if it reaches
// beyond the frames shown.
std::vector<double> over_cycle(const ChartedMotion& motion, std::span<const double> curve,
                               const GaitCycle& cycle) {
  const double rate = motion.clip->rate;
  if (cycle.strike * rate < motion.frames.first - 0.5 ||
      cycle.next * rate > motion.frames.last + 0.5) {
    return {};
  }
  std::vector<double> values;
  for (int i = 0; i <= kParts; ++i) {
    const double time = cycle.strike + (cycle.next - cycle.strike) * i / kParts;
    const double place =
        std::clamp(time * rate - motion.frames.first, 0.0, static_cast<double>(curve.size() - 1));
    const auto before = std::min(static_cast<std::size_t>(place), curve.size() - 1);
    const std::size_t after = std::min(before + 1, curve.size() - 1);
    values.push_back(curve[before] +
                     (place - static_cast<double>(before)) * (curve[after] - curve[before]));
  }
  return values;
}

// The mean of curves and a band of a standard deviation about it.
void add_mean(const std::vector<std::vector<double>>& curves, Side side, Panel& panel) {
  std::vector<double> percent, mean, around;
  for (int i = 0; i <= kParts; ++i) {
    const auto at = static_cast<std::size_t>(i);
    double sum = 0, squares = 0;
    const auto count = static_cast<double>(curves.size());
    for (const auto& curve : curves) sum += curve[at] / count;
    for (const auto& curve : curves) squares += (curve[at] - sum) * (curve[at] - sum);
    percent.push_back(100.0 * i / kParts);
    mean.push_back(sum);
    around.push_back(curves.size() > 1 ? std::sqrt(squares / (count - 1)) : 0);
  }
  if (curves.size() > 1) {
    Series band;
    for (const int way : {1, -1}) {
      for (std::size_t i = 0; i < mean.size(); ++i) {
        const std::size_t at = way > 0 ? i : mean.size() - 1 - i;
        band.x.push_back(percent[at]);
        band.y.push_back(mean[at] + way * around[at]);
      }
    }
    band.colour = side_colour(side);
    band.dash = 0;
    band.faint = band.filled = true;
    panel.series.push_back(std::move(band));
  }
  Series line;
  line.name = side == Side::left ? "left" : "right";
  line.x = std::move(percent);
  line.y = std::move(mean);
  line.colour = side_colour(side);
  line.dash = side == Side::left ? 0 : 1;
  panel.series.push_back(std::move(line));
}

}  // namespace

CycleCharts cycle_charts(std::span<const ChartedMotion> motions) {
  CycleCharts charts;
  std::array<double, 2> off{};  // sums of percents
  std::vector<bool> has_cycle(motions.size(), false);
  std::vector<int> cycles(motions.size(), 0);
  for (const BodyAngleName& name : kBodyAngles) {
    Panel panel;
    panel.title = name.title;
    panel.x = {"gait cycle", "%", Scale::linear, 0, 100};
    panel.y = {"angle", kDegrees};
    for (const Side side : {Side::left, Side::right}) {
      std::vector<std::vector<double>> curves;
      std::size_t s = side == Side::left ? 0 : 1;
      for (std::size_t m = 0; m < motions.size(); ++m) {
        const ChartedMotion& motion = motions[m];
        const auto angles =
            body_angle(*motion.clip, *motion.roles, name.angle, side, motion.frames);
        if (angles.empty()) continue;
        for (const GaitCycle& cycle :
             gait_cycles(motion.keys.keytimes, s == 0 ? FootSide::left : FootSide::right)) {
          auto values = over_cycle(motion, angles, cycle);
          if (values.empty() ||
              !std::ranges::all_of(values, [](double v) { return std::isfinite(v); })) {
            continue;
          }
          curves.push_back(std::move(values));
          has_cycle[m] = true;
          if (charts.panels.empty()) {
            ++charts.counts[s];
            ++cycles[m];
            const double stance = (cycle.off - cycle.strike) / (cycle.next - cycle.strike);
            if (stance < 0.5) ++charts.runs;
            off[s] += 100 * stance;
          }
        }
      }
      if (!curves.empty()) add_mean(curves, side, panel);
    }
    if (panel.series.empty()) continue;
    for (std::size_t s = 0; s < 2; ++s) {
      if (charts.counts[s] == 0) continue;
      panel.moments.push_back({off[s] / charts.counts[s], s == 0 ? "L off" : "R off"});
    }
    constexpr double kOneLabel = 4;  // percent; two labels would overlap
    if (panel.moments.size() == 2 &&
        std::abs(panel.moments[0].at - panel.moments[1].at) < kOneLabel) {
      panel.moments[0].name = "L, R off";
      panel.moments[1].name.clear();
    }
    charts.panels.push_back(std::move(panel));
  }
  charts.motions = static_cast<int>(std::ranges::count(has_cycle, true));
  if (const auto max = std::ranges::max_element(cycles); max != cycles.end() && *max > 0) {
    charts.max_cycles = *max;
    charts.max_cycles_of = static_cast<int>(max - cycles.begin());
  }
  return charts;
}

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
