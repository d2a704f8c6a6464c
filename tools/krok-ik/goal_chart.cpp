#include "tools/krok-ik/goal_chart.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/index.h"
#include "core/numbers.h"
#include "ik/limits.h"

namespace krok::cli::ik {

namespace {

using krok::ik::Goal;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();  // breaks a line

bool has_distance(Goal::Kind kind) {
  return kind == Goal::Kind::position || kind == Goal::Kind::pose || kind == Goal::Kind::balance;
}
bool has_angle(Goal::Kind kind) {
  return kind == Goal::Kind::orientation || kind == Goal::Kind::pose ||
         kind == Goal::Kind::look_at || kind == Goal::Kind::pole;
}

class ChartMaker {
 public:
  ChartMaker(const Outcome& outcome, const Clip& given) : outcome_(outcome), given_(given) {
    for (int f = 0; f < given.frame_count(); ++f) times_.push_back(f / given.rate);
  }

  // What is less than this is a line at 0, not a mountain range of rounding errors.
  static constexpr double kFewMillimetres = 1, kFewDegrees = 0.1;

  // One line a goal; it breaks where the goal is not active.
  draw::Panel residuals(bool angles) const {
    draw::Panel panel =
        over_time(angles ? "Angle by which goals are missed" : "Distance by which goals are missed",
                  angles ? "angle" : "distance", angles ? "\u00B0" : "mm");
    for (std::size_t g = 0; g < outcome_.goals.size(); ++g) {
      const Goal::Kind kind = outcome_.goals[g].goal.kind;
      if (!(angles ? has_angle(kind) : has_distance(kind))) continue;
      std::vector<double> values(times_.size(), kGap);
      for (const krok::ik::GoalFrame& frame : outcome_.motion.goals[g]) {
        values[at(frame.frame)] =
            angles ? frame.residual.angle / kRadiansPerDegree : frame.residual.distance * 1000;
      }
      // The same colour for the same goal in all panels.
      add(outcome_.goals[g].name, std::move(values), static_cast<int>(g), panel);
    }
    widen(angles ? kFewDegrees : kFewMillimetres, panel);
    return panel;
  }

  // A line at a height of its own for each joint, over the times in which its limits hold a goal
  // back.
  draw::Panel holders() const {
    draw::Panel panel = over_time("Joints whose limits hold a goal back", "joint", "");
    std::map<int, std::vector<double>> held;  // by joint
    for (const auto& frames : outcome_.motion.goals) {
      for (const krok::ik::GoalFrame& frame : frames) {
        if (frame.residual.held_by < 0) continue;
        held.try_emplace(frame.residual.held_by, times_.size(), kGap)
            .first->second[at(frame.frame)] = 0;
      }
    }
    int place = 0;
    for (auto& [joint, values] : held) {
      ++place;
      for (double& value : values) value += place;
      add(outcome_.input.skeleton.names[at(joint)], std::move(values), place - 1, panel);
    }
    panel.y.low = 0;
    panel.y.high = place + 1;
    return panel;
  }

  draw::Panel beyond_limits() const {
    draw::Panel panel =
        over_time("Rotation beyond limits, largest of all joints", "angle", "\u00B0");
    add("input", excesses(given_), 6, panel);
    add("result", excesses(outcome_.motion.clip), 0, panel);
    widen(kFewDegrees, panel);
    return panel;
  }

 private:
  draw::Panel over_time(const char* title, const char* label, const char* unit) const {
    draw::Panel panel;
    panel.title = title;
    panel.x = {"time", "s"};
    if (times_.size() > 1) {
      panel.x.low = times_.front();
      panel.x.high = times_.back();
    }
    panel.y.label = label;
    panel.y.unit = unit;
    panel.y.low = 0;
    return panel;
  }

  static void widen(double least, draw::Panel& panel) {
    for (const draw::Series& series : panel.series) {
      for (const double value : series.y) {
        if (value >= least) return;
      }
    }
    panel.y.high = least;
  }

  void add(std::string name, std::vector<double> values, int colour, draw::Panel& panel) const {
    draw::Series series;
    series.name = std::move(name);
    series.x = times_;
    series.y = std::move(values);
    series.colour = colour;
    panel.series.push_back(std::move(series));
  }

  // Degrees, in each frame.
  std::vector<double> excesses(const Clip& clip) const {
    const auto& parents = clip.skeleton.parents;
    std::vector<Transform> world(parents.size()), local(parents.size());
    std::vector<double> largest;
    for (int f = 0; f < clip.frame_count(); ++f) {
      clip.get_pose(f, world);
      world_to_local(parents, world, local);
      double most = 0;
      for (std::size_t j = 1; j < local.size(); ++j) {
        most = std::max(most, excess(outcome_.limits[j], local[j].orientation));
      }
      largest.push_back(most / kRadiansPerDegree);
    }
    return largest;
  }

  const Outcome& outcome_;
  const Clip& given_;
  std::vector<double> times_;  // [frames], seconds
};

}  // namespace

draw::Chart chart_of(const Outcome& outcome, const Clip& given, const std::string& title) {
  const ChartMaker maker(outcome, given);
  draw::Chart chart;
  chart.title = title;
  for (const bool angles : {false, true}) {
    draw::Panel panel = maker.residuals(angles);
    if (!panel.series.empty()) chart.panels.push_back(std::move(panel));
  }
  if (!outcome.limits.empty()) {
    draw::Panel panel = maker.holders();
    if (!panel.series.empty()) chart.panels.push_back(std::move(panel));
    chart.panels.push_back(maker.beyond_limits());
  }
  chart.panel_height = 180;
  return chart;
}

}  // namespace krok::cli::ik
