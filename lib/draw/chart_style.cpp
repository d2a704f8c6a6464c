#include "draw/chart_style_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace krok::draw {

int motion_colour(std::size_t place) {
  // Distinct from the colours of the sides; the first is black.
  constexpr std::array kColours = {6, 3, 2, 5, 1};
  return kColours[place % kColours.size()];
}

std::vector<double> times_of(const ChartedMotion& motion) {
  std::vector<double> times;
  for (int f = motion.frames.first; f <= motion.frames.last; ++f) {
    times.push_back(f / motion.clip->rate);
  }
  return times;
}

Panel time_panel(std::span<const ChartedMotion> motions, std::string title, std::string label,
                 std::string unit) {
  Panel panel;
  panel.title = std::move(title);
  panel.legend = false;
  panel.x = {"time", "s"};
  panel.y.label = std::move(label);
  panel.y.unit = std::move(unit);
  double low = INFINITY, high = -INFINITY;
  for (const ChartedMotion& motion : motions) {
    if (motion.frames.first > motion.frames.last) continue;
    low = std::min(low, motion.frames.first / motion.clip->rate);
    high = std::max(high, motion.frames.last / motion.clip->rate);
  }
  if (low < high) {
    panel.x.low = low;
    panel.x.high = high;
  }
  return panel;
}

Series motion_line(const ChartedMotion& motion, std::size_t place, std::vector<double> values) {
  Series series;
  series.name = motion.name;
  series.x = times_of(motion);
  series.y = std::move(values);
  series.colour = motion_colour(place);
  series.dash = static_cast<int>(place);
  return series;
}

Series side_line(const ChartedMotion& motion, std::size_t place, Side side,
                 std::vector<double> values) {
  Series series = motion_line(motion, place, std::move(values));
  series.name = fmt::format("{}, {}", side == Side::left ? "left" : "right", motion.name);
  series.colour = side_colour(side);
  return series;
}

std::vector<LegendEntry> motion_legend(std::span<const ChartedMotion> motions,
                                       std::span<const Panel> panels) {
  std::vector<LegendEntry> legend;
  for (const Panel& panel : panels) {
    if (panel.legend) continue;
    for (const Series& series : panel.series) {
      if (series.name.empty() || series.style == SeriesStyle::points) continue;
      const bool side = series.colour == kLeftColour || series.colour == kRightColour;
      if (motions.size() < 2 && !side) continue;
      const bool known = std::ranges::any_of(legend, [&](const LegendEntry& entry) {
        return entry.colour == series.colour && entry.dash == series.dash;
      });
      if (known) continue;
      LegendEntry entry{series.name, series.colour, series.dash};
      if (motions.size() < 2) entry.name = series.colour == kLeftColour ? "left" : "right";
      legend.push_back(std::move(entry));
    }
  }
  // Motion by motion, whatever panel comes first.
  std::ranges::stable_sort(legend, {}, &LegendEntry::dash);
  return legend;
}

Side side_of_foot(const ChartedMotion& motion, int joint) {
  while (joint >= 0) {
    switch (motion.roles->roles[static_cast<std::size_t>(joint)]) {
      case Role::left_foot:
      case Role::left_toes:
        return Side::left;
      case Role::right_foot:
      case Role::right_toes:
        return Side::right;
      default:
        joint = motion.clip->skeleton.parents[static_cast<std::size_t>(joint)];
    }
  }
  return Side::middle;
}

void add_keys(std::span<const ChartedMotion> motions, bool names, Panel& panel) {
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const ChartedMotion& motion = motions[m];
    const double first = motion.frames.first / motion.clip->rate;
    const double last = motion.frames.last / motion.clip->rate;
    const std::string number = motions.size() > 1 ? fmt::format("{}", m + 1) : "";
    for (const Side side : {Side::right, Side::left}) {
      const auto lane = static_cast<int>(panel.lanes.size());
      bool any = false;
      for (const Contact& contact : motion.keys.contacts) {
        if (side_of_foot(motion, contact.joint) != side) continue;
        any = true;
        const double from = std::max(contact.start, first), to = std::min(contact.end, last);
        if (from <= to) panel.spans.push_back({from, to, lane, side_colour(side)});
      }
      if (any) panel.lanes.push_back((side == Side::left ? "L" : "R") + number);
    }
    for (const Keytime& key : motion.keys.keytimes) {
      if (key.time < first || key.time > last) continue;
      panel.moments.push_back({key.time, names ? key.name : std::string()});
    }
  }
}

}  // namespace krok::draw
