#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "draw/chart_style_internal.h"
#include "draw/ground_chart_internal.h"
#include "motion/ground_frame.h"

namespace krok::draw {

namespace {

constexpr int kMaxDots = 15;
constexpr double kMinExtent = 0.5;  // metres; minimum extent, so that jitter is not magnified

Vec3 carrier_position(const ChartedMotion& motion, int frame) {
  const auto carrier = static_cast<std::size_t>(carrying_joint(*motion.roles));
  return motion.clip->frame_positions(frame)[carrier].cast<double>();
}

// A round time step between dots that limits their number on the longest motion.
double dot_step(std::span<const ChartedMotion> motions) {
  double longest = 0;
  for (const ChartedMotion& motion : motions) {
    longest = std::max(longest, (motion.frames.last - motion.frames.first) / motion.clip->rate);
  }
  for (double power = 0.1; power < 1e9; power *= 10) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (longest <= kMaxDots * factor * power) return factor * power;
    }
  }
  return 1e9;
}

Series path_of(const ChartedMotion& motion, std::size_t place) {
  Series path;
  path.name = motion.name;
  for (int f = motion.frames.first; f <= motion.frames.last; ++f) {
    const Vec3 position = carrier_position(motion, f);
    path.x.push_back(position.z());
    path.y.push_back(position.x());
  }
  path.colour = motion_colour(place);
  path.dash = static_cast<int>(place);
  path.arrow = true;
  return path;
}

// Positions on the path every `step` seconds from the first frame shown.
Series dots_of(const ChartedMotion& motion, std::size_t place, double step) {
  Series dots;
  dots.style = SeriesStyle::points;
  dots.colour = motion_colour(place);
  const double rate = motion.clip->rate;
  for (int k = 0;; ++k) {
    const double frame = motion.frames.first + k * step * rate;
    if (!(frame <= motion.frames.last + 1e-6)) break;
    const int before = std::min(static_cast<int>(std::floor(frame + 1e-6)), motion.frames.last);
    const int after = std::min(before + 1, motion.frames.last);
    const double share = std::clamp(frame - before, 0.0, 1.0);
    const Vec3 position =
        (1 - share) * carrier_position(motion, before) + share * carrier_position(motion, after);
    dots.x.push_back(position.z());
    dots.y.push_back(position.x());
  }
  return dots;
}

// Foot contact positions, in the colours of their sides.
void add_places(const ChartedMotion& motion, Panel& panel) {
  const double first = motion.frames.first / motion.clip->rate;
  const double last = motion.frames.last / motion.clip->rate;
  for (const Side side : {Side::left, Side::right}) {
    Series places;
    places.style = SeriesStyle::points;
    places.colour = side_colour(side);
    for (const Contact& contact : motion.keys.contacts) {
      if (side_of_foot(motion, contact.joint) != side) continue;
      if (contact.end < first || contact.start > last) continue;
      places.x.push_back(contact.place.z());
      places.y.push_back(contact.place.x());
    }
    if (!places.x.empty()) panel.series.push_back(std::move(places));
  }
}

void add_ways_of_feet(const ChartedMotion& motion, Panel& panel) {
  for (const Side side : {Side::left, Side::right}) {
    const int foot = motion.roles->joint(side == Side::left ? Role::left_foot : Role::right_foot);
    if (foot < 0) continue;
    Series way;
    way.colour = side_colour(side);
    way.dash = 0;
    way.faint = true;
    for (int f = motion.frames.first; f <= motion.frames.last; ++f) {
      const Vec3f& at = motion.clip->frame_positions(f)[static_cast<std::size_t>(foot)];
      way.x.push_back(at.z());
      way.y.push_back(at.x());
    }
    panel.series.push_back(std::move(way));
  }
}

// Limits with a margin, at least kMinExtent wide.
void set_limits(Panel& panel) {
  const auto limit = [](Axis& axis, const auto& values_of, const std::vector<Series>& all) {
    double low = INFINITY, high = -INFINITY;
    for (const Series& series : all) {
      for (const double value : values_of(series)) {
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
    if (!(low <= high)) return;
    const double half = std::max((high - low) * 0.54, kMinExtent / 2);
    axis.low = (low + high) / 2 - half;
    axis.high = (low + high) / 2 + half;
  };
  limit(
      panel.x, [](const Series& s) -> const auto& { return s.x; }, panel.series);
  limit(
      panel.y, [](const Series& s) -> const auto& { return s.y; }, panel.series);
}

// Widens the shorter axis so that the ground fills a panel of the usual shape.
void fill_panel(Panel& panel) {
  constexpr double kShape = 2;  // width by height
  if (!panel.x.low || !panel.y.low) return;
  const double wide = *panel.x.high - *panel.x.low, high = *panel.y.high - *panel.y.low;
  Axis& axis = wide < kShape * high ? panel.x : panel.y;
  const double more = wide < kShape * high ? kShape * high - wide : wide / kShape - high;
  *axis.low -= more / 2;
  *axis.high += more / 2;
}

}  // namespace

std::vector<Panel> path_panels(std::span<const ChartedMotion> motions,
                               const ChartedGround& ground) {
  Panel panel;
  const bool on_ground = ground.height || !ground.prints.empty();
  const double step = dot_step(motions);
  panel.title = fmt::format("Path from above, a dot every {} s", readable(step));
  panel.x = {"z", "m"};
  panel.y = {"x", "m"};
  panel.same_scale = true;
  panel.legend = false;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    panel.series.push_back(path_of(motions[m], m));
    panel.series.push_back(dots_of(motions[m], m, step));
    if (on_ground) {
      add_ways_of_feet(motions[m], panel);
    } else {
      add_places(motions[m], panel);
    }
  }
  add_prints(ground, panel);
  set_limits(panel);
  if (ground.height) fill_panel(panel);
  if (ground.height) add_heights(motions, ground, panel);
  return {std::move(panel)};
}

}  // namespace krok::draw
