#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "core/numbers.h"
#include "draw/chart_style_internal.h"
#include "draw/motion_charts.h"
#include "motion/hips_root.h"

namespace krok::draw {

namespace {

constexpr int kSamples = 160;         // along the longer side
constexpr double kLevel = 0.002;      // metres between highest and lowest: less is level
constexpr int kContours = 10;         // about so many heights have a line
constexpr double kMaxNumbered = 200;  // footprints: more would hide one another's numbers

// Heights on a regular grid over the panel: columns along x, rows along y.
struct Heights {
  int columns = 0, rows = 0;
  double x_low = 0, y_low = 0, step_x = 0, step_y = 0;
  std::vector<double> values;  // NaN where there is no ground

  double at(int row, int column) const {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(column)];
  }
};

Heights sample(std::span<const ChartedMotion> motions, const ChartedGround& ground,
               const Panel& panel) {
  float top = -std::numeric_limits<float>::infinity();
  for (const ChartedMotion& motion : motions) {
    for (const Vec3f& at : motion.clip->positions) top = std::max(top, at.y());
  }
  Heights heights;
  const double wide = *panel.x.high - *panel.x.low, high = *panel.y.high - *panel.y.low;
  const double step = std::max(wide, high) / kSamples;
  heights.columns = std::max(2, static_cast<int>(std::lround(wide / step)));
  heights.rows = std::max(2, static_cast<int>(std::lround(high / step)));
  heights.step_x = wide / heights.columns;
  heights.step_y = high / heights.rows;
  heights.x_low = *panel.x.low + heights.step_x / 2;
  heights.y_low = *panel.y.low + heights.step_y / 2;
  for (int row = 0; row < heights.rows; ++row) {
    for (int column = 0; column < heights.columns; ++column) {
      const Vec3 point(heights.y_low + row * heights.step_y, top,
                       heights.x_low + column * heights.step_x);
      heights.values.push_back(
          ground.height(point).value_or(std::numeric_limits<double>::quiet_NaN()));
    }
  }
  return heights;
}

// Lines of one height by marching squares: each cell joins the crossings of its edges, which are
// then strung together.
class ContourLines {
 public:
  ContourLines(const Heights& heights, double height) : heights_(heights), height_(height) {
    for (int row = 0; row + 1 < heights.rows; ++row) {
      for (int column = 0; column + 1 < heights.columns; ++column) join_in_cell(row, column);
    }
  }

  Series lines() {
    Series series;
    // Open lines from their ends, then closed ones.
    for (const bool ends_only : {true, false}) {
      for (auto& [edge, neighbours] : next_) {
        if (neighbours.empty() || (ends_only && neighbours.size() != 1)) continue;
        follow(edge, series);
      }
    }
    return series;
  }

 private:
  // An edge of the grid: from the sample (row, column) along x or along y.
  struct Edge {
    int row = 0, column = 0;
    bool along_x = true;
    auto operator<=>(const Edge&) const = default;  // NOLINT(modernize-use-nullptr): LLVM 14
  };

  bool crosses(const Edge& edge) const {
    const auto [a, b] = ends(edge);
    return std::isfinite(a) && std::isfinite(b) && (a < height_) != (b < height_);
  }
  std::pair<double, double> ends(const Edge& edge) const {
    return {heights_.at(edge.row, edge.column),
            heights_.at(edge.row + (edge.along_x ? 0 : 1), edge.column + (edge.along_x ? 1 : 0))};
  }
  Vec2 place(const Edge& edge) const {
    const auto [a, b] = ends(edge);
    const double share = (height_ - a) / (b - a);
    return {heights_.x_low + (edge.column + (edge.along_x ? share : 0)) * heights_.step_x,
            heights_.y_low + (edge.row + (edge.along_x ? 0 : share)) * heights_.step_y};
  }
  void join(const Edge& a, const Edge& b) {
    next_[a].push_back(b);
    next_[b].push_back(a);
  }
  void join_in_cell(int row, int column) {
    // In order round the cell.
    const std::array<Edge, 4> edges = {Edge{row, column, true}, Edge{row, column + 1, false},
                                       Edge{row + 1, column, true}, Edge{row, column, false}};
    std::vector<Edge> crossed;
    for (const Edge& edge : edges) {
      if (crosses(edge)) crossed.push_back(edge);
    }
    if (crossed.size() == 2) join(crossed[0], crossed[1]);
    if (crossed.size() != 4) return;
    // A saddle: its middle says which corners belong together.
    const double middle = (heights_.at(row, column) + heights_.at(row, column + 1) +
                           heights_.at(row + 1, column) + heights_.at(row + 1, column + 1)) /
                          4;
    const bool as_first = (middle < height_) == (heights_.at(row, column) < height_);
    join(crossed[0], crossed[as_first ? 1 : 3]);
    join(crossed[2], crossed[as_first ? 3 : 1]);
  }
  void follow(Edge edge, Series& series) {
    const auto add = [&](const Vec2& at) {
      series.x.push_back(at.x());
      series.y.push_back(at.y());
    };
    add(place(edge));
    while (!next_[edge].empty()) {
      const Edge to = next_[edge].back();
      next_[edge].pop_back();
      std::erase(next_[to], edge);
      edge = to;
      add(place(edge));
    }
    add(Vec2::Constant(std::numeric_limits<double>::quiet_NaN()));
  }

  const Heights& heights_;
  double height_;
  std::map<Edge, std::vector<Edge>> next_;
};

// The footprints, as soles with their numbers.
void add_prints(const ChartedGround& ground, Panel& panel) {
  const std::vector<Vec2> outline = sole_outline();
  for (const ViewedPrint& print : ground.prints) {
    const Vec3 left = print.up.cross(print.forward);
    Series sole;
    sole.colour = side_colour(print.left ? Side::left : Side::right);
    sole.dash = 0;
    sole.filled = true;
    for (std::size_t i = 0; i <= outline.size(); ++i) {
      const Vec2& point = outline[i % outline.size()];
      const Vec3 at = print.heel + print.length * ((print.left ? 1 : -1) * point.x() * left +
                                                   point.y() * print.forward);
      sole.x.push_back(at.z());
      sole.y.push_back(at.x());
    }
    panel.series.push_back(std::move(sole));
    if (static_cast<double>(ground.prints.size()) > kMaxNumbered) continue;
    // Beside the sole, on its outer side.
    const Vec3 beside =
        print.heel + print.length * ((print.left ? 0.5 : -0.5) * left + 0.5 * print.forward);
    panel.notes.push_back({beside.z(), beside.x(), std::to_string(print.number)});
  }
}

// Heights of the ground within the panel's limits, as a field and contour lines; nothing if it is
// level. They are those below the motions' highest joints.
void add_heights(std::span<const ChartedMotion> motions, const ChartedGround& ground,
                 Panel& panel) {
  if (!panel.x.low || !panel.y.low) return;
  Heights heights = sample(motions, ground, panel);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : heights.values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(high - low > kLevel)) return;
  for (const double height : ticks(low, high, kContours, Scale::linear)) {
    // A hair beside a round height, at which whole areas may lie.
    Series lines = ContourLines(heights, height + 1e-6 * (high - low)).lines();
    if (!lines.x.empty()) panel.contours.push_back(std::move(lines));
  }
  panel.title = "From above; ground in m";
  panel.field = Field{*panel.x.low,
                      *panel.x.high,
                      *panel.y.low,
                      *panel.y.high,
                      heights.columns,
                      heights.rows,
                      std::move(heights.values)};
  panel.field->faint = true;
}

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
