#include "tools/krok-diff/difference_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/file.h"
#include "core/text.h"
#include "draw/difference_chart.h"
#include "formats/chart/chart_writer.h"
#include "roles/roles.h"
#include "tools/cli/output_set.h"

namespace krok::cli::diff {

namespace {

using draw::ChartedDifference;
using draw::Scale;

constexpr std::size_t kMaxAnimations = 8;

Result<Plot> finished(const draw::Chart& chart, std::size_t left_out) {
  auto svg = draw::to_svg(chart);
  if (!svg) return svg.error();
  return Plot{*std::move(svg), left_out};
}

// Adds the tolerance and the time of the max.
void add_measure(const compare::Measure& measure, ChartedDifference& chart) {
  chart.tolerance = chart.is_angle ? measure.tolerance / kRadiansPerDegree : measure.tolerance;
  if (measure.largest > 0) chart.worst_moment = measure.where.time;
}

// A quantity compared between scenes.
struct Quantity {
  const char* title;
  const char* of;
  bool is_angle;
  compare::MomentValue compare::MomentDifference::*value;
  compare::Measure compare::SceneDifference::*measure;
};
constexpr Quantity kQuantities[] = {
    {"Distance between vertices", "vertices", false, &compare::MomentDifference::positions,
     &compare::SceneDifference::positions},
    {"Angle between normals", "vertices", true, &compare::MomentDifference::normals,
     &compare::SceneDifference::normals},
    {"Angle between tangents", "vertices", true, &compare::MomentDifference::tangents,
     &compare::SceneDifference::tangents},
    {"Distance between joints", "joints", false, &compare::MomentDifference::joint_positions,
     &compare::SceneDifference::joint_positions},
    {"Angle between joints", "joints", true, &compare::MomentDifference::joint_orientations,
     &compare::SceneDifference::joint_orientations},
};

using Moments = std::vector<const compare::MomentDifference*>;

ChartedDifference chart_of(const Quantity& quantity, const Moments& moments,
                           const compare::SceneDifference& found) {
  ChartedDifference chart;
  chart.title = quantity.title;
  chart.of = quantity.of;
  chart.is_angle = quantity.is_angle;
  const double unit = quantity.is_angle ? 1 / kRadiansPerDegree : 1;
  for (const compare::MomentDifference* moment : moments) {
    const compare::MomentValue& value = moment->*quantity.value;
    chart.times.push_back(moment->time);
    chart.largest.push_back(unit * static_cast<double>(value.largest));
    chart.rms.push_back(unit * static_cast<double>(value.rms));
  }
  const compare::Measure& measure = found.*quantity.measure;
  add_measure(measure, chart);
  // The overall max may be in another animation.
  if (std::max(0, measure.where.animation) != std::max(0, moments.front()->animation)) {
    chart.worst_moment.reset();
  }
  return chart;
}

bool differs(const Moments& moments, const compare::SceneDifference& found) {
  return std::any_of(moments.begin(), moments.end(), [&](const compare::MomentDifference* moment) {
    return std::any_of(std::begin(kQuantities), std::end(kQuantities), [&](const Quantity& one) {
      return static_cast<double>((moment->*one.value).largest) > (found.*one.measure).tolerance;
    });
  });
}

}  // namespace

Result<Plot> plot_of(const PlottedClip& first, const PlottedClip& second,
                     const compare::ClipDifference& found) {
  const RoleMap first_roles = find_roles(first.clip->skeleton);
  const RoleMap second_roles = find_roles(second.clip->skeleton);
  draw::ChartedMotion a{first.name, first.clip, &first_roles, {}, {}};
  draw::ChartedMotion b{second.name, second.clip, &second_roles, {}, {}};
  a.frames = {0, first.clip->frame_count() - 1};
  b.frames = {0, second.clip->frame_count() - 1};
  const auto difference = draw::difference_over_time(a, b, {});
  if (!difference) return Error("diff-plot", difference.error().message);
  draw::Chart chart;
  chart.title = fmt::format("{} and {}", first.name, second.name);
  auto [distances, angles] = draw::difference_charts(*difference);
  add_measure(found.positions, distances);
  add_measure(found.orientations, angles);
  for (const ChartedDifference* charted : {&distances, &angles}) {
    chart.panels.push_back(draw::difference_panel(*charted, Scale::linear));
  }
  return finished(chart, 0);
}

Result<Plot> plot_of(const PlottedScenes& scenes) {
  const compare::SceneDifference& found = *scenes.found;
  std::map<int, Moments> animations;
  for (const compare::MomentDifference& moment : found.moments) {
    if (moment.frame >= 0) animations[moment.animation].push_back(&moment);
  }
  if (animations.empty()) return Error("diff-plot", "the two have no animation in common");
  const bool any = std::any_of(animations.begin(), animations.end(),
                               [&](const auto& one) { return differs(one.second, found); });
  const bool several = animations.size() > 1;
  draw::Chart chart;
  chart.title = fmt::format("{} and {}", scenes.first_name, scenes.second_name);
  std::size_t drawn = 0, left = 0;
  for (const auto& [animation, moments] : animations) {
    if (several && any && !differs(moments, found)) continue;
    if (drawn == kMaxAnimations) {
      ++left;
      continue;
    }
    ++drawn;
    const auto place = static_cast<std::size_t>(std::max(0, animation));
    std::string name =
        place < scenes.first->animations.size() ? scenes.first->animations[place].name : "";
    if (name.empty()) name = fmt::format("animation {}", animation);
    for (const Quantity& quantity : kQuantities) {
      if ((found.*quantity.measure).count == 0) continue;
      ChartedDifference charted = chart_of(quantity, moments, found);
      if (several) charted.title = name + ": " + charted.title;
      chart.panels.push_back(draw::difference_panel(charted, Scale::linear));
    }
  }
  if (chart.panels.empty()) {
    return Error("diff-plot", "the two have neither meshes nor joints in common");
  }
  return finished(chart, left);
}

Status write_plot(const Result<Plot>& plot, const std::string& path, ToolContext& context) {
  if (!plot && plot.error().code != "diff-plot") return plot.error();
  if (!plot) {
    context.warn("diff-plot", fmt::format("{} is not drawn: {}", path, plot.error().message));
    return {};
  }
  if (plot->left_out > 0) {
    context.warn("diff-plot",
                 fmt::format("{} more animations that differ are not drawn", plot->left_out));
  }
  return write_output(context, path,
                      [&](OutputFile& file) { return chart::write(path, plot->svg, file); });
}

}  // namespace krok::cli::diff
