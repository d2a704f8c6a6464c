#include "draw/plot_panel_internal.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <set>
#include <utility>

#include "draw/chart_style_internal.h"

namespace krok::draw {

namespace {

constexpr double kThinning = 0.02;  // pixels
// Points simplified together: the worst case is quadratic in time.
constexpr std::size_t kPiece = 4096;
constexpr double kArrowLength = 9.0;
constexpr double kArrowWidth = 7.0;

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double square = dx * dx + dy * dy;
  const double along =
      square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}

// Drops points of the line that fall on the same x position: of each such group, the first, the
// highest, the lowest and the last remain.
std::vector<Point> gathered(const std::vector<Point>& line) {
  std::vector<Point> result;
  for (std::size_t first = 0; first < line.size();) {
    std::size_t end = first, high = first, low = first;
    for (; end < line.size() && std::abs(line[end].x - line[first].x) < kThinning; ++end) {
      if (line[end].y < line[high].y) high = end;
      if (line[end].y > line[low].y) low = end;
    }
    std::array<std::size_t, 4> kept = {first, high, low, end - 1};
    std::sort(kept.begin(), kept.end());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      if (k == 0 || kept[k] != kept[k - 1]) result.push_back(line[kept[k]]);
    }
    first = end;
  }
  return result;
}

// Marks the points from `begin` to `end` that must be kept to stay within kThinning of the line
// (Douglas and Peucker, 1973).
void mark_corners(const std::vector<Point>& line, std::size_t begin, std::size_t end,
                  std::vector<std::uint8_t>& kept) {
  kept[begin] = kept[end] = 1;
  std::vector<std::pair<std::size_t, std::size_t>> open = {{begin, end}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double farthest = kThinning;
    std::size_t corner = first;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance = distance_to_segment(line[i], line[first], line[last]);
      if (distance > farthest) {
        farthest = distance;
        corner = i;
      }
    }
    if (corner == first) continue;
    kept[corner] = 1;
    open.emplace_back(first, corner);
    open.emplace_back(corner, last);
  }
}

std::vector<Point> thinned(const std::vector<Point>& run) {
  const std::vector<Point> line = gathered(run);
  std::vector<std::uint8_t> kept(line.size(), 0);
  for (std::size_t begin = 0; begin < line.size(); begin += kPiece) {
    mark_corners(line, begin, std::min(begin + kPiece, line.size() - 1), kept);
  }
  std::vector<Point> result;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (kept[i] != 0) result.push_back(line[i]);
  }
  return result;
}

}  // namespace

std::vector<std::vector<Point>> runs_of(const Series& series, const PlotArea& area) {
  std::vector<std::vector<Point>> runs;
  std::vector<Point> run;
  const auto finish = [&] {
    if (!run.empty()) runs.push_back(thinned(run));
    run.clear();
  };
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (area.shows(series.x[i], series.y[i])) {
      run.push_back({area.at_x(series.x[i]), area.at_y(series.y[i])});
    } else {
      finish();
    }
  }
  finish();
  return runs;
}

std::vector<Point> points_of(const Series& series, const PlotArea& area) {
  std::set<std::pair<std::int64_t, std::int64_t>> taken;
  std::vector<Point> points;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!area.shows(series.x[i], series.y[i])) continue;
    const Point point = {area.at_x(series.x[i]), area.at_y(series.y[i])};
    if (taken.emplace(std::llround(point.x * 4), std::llround(point.y * 4)).second) {
      points.push_back(point);
    }
  }
  return points;
}

std::string path_of(const std::vector<std::vector<Point>>& runs) {
  std::string path;
  for (const auto& run : runs) {
    if (run.size() == 1) {
      path += fmt::format("M{} {}h{}", number(run[0].x - kLineWidth / 2), number(run[0].y),
                          number(kLineWidth));
      continue;
    }
    for (std::size_t i = 0; i < run.size(); ++i) {
      path += fmt::format("{}{} {}", i == 0 ? "M" : "L", number(run[i].x), number(run[i].y));
    }
  }
  return path;
}

std::vector<Point> arrow_head(const std::vector<std::vector<Point>>& runs) {
  if (runs.empty()) return {};
  const Point tip = runs.back().back();
  // Go back far enough to distinguish the line's direction from jitter.
  const auto begin = std::find_if(runs.back().rbegin(), runs.back().rend(), [&](const Point& p) {
    return std::hypot(tip.x - p.x, tip.y - p.y) >= kArrowLength;
  });
  if (begin == runs.back().rend()) return {};
  const double distance = std::hypot(tip.x - begin->x, tip.y - begin->y);
  const Point along = {(tip.x - begin->x) / distance, (tip.y - begin->y) / distance};
  const Point foot = {tip.x - along.x * kArrowLength, tip.y - along.y * kArrowLength};
  const double half = kArrowWidth / 2;
  return {tip,
          {foot.x - along.y * half, foot.y + along.x * half},
          {foot.x + along.y * half, foot.y - along.x * half}};
}

namespace {

constexpr int kMaxCells = 1000;   // per row and per column
constexpr int kColourSteps = 24;  // approximate
constexpr double kBarStep = 4.0;  // pixels of the colour bar per colour
constexpr double kBarHeight = 8.0;

using Colour = std::array<double, 3>;

// White, a light and a dark tone at equal distances; after ColorBrewer's PuOr scheme, which is safe
// for colour-blind readers.
constexpr std::array<Colour, 3> kAbove = {{{255, 255, 255}, {253, 184, 99}, {179, 88, 6}}};
constexpr std::array<Colour, 3> kBelow = {{{255, 255, 255}, {178, 171, 210}, {84, 39, 136}}};

std::string tone(const std::array<Colour, 3>& colours, double part) {
  const std::size_t half = part < 0.5 ? 0 : 1;
  const double between = 2 * part - static_cast<double>(half);
  std::array<int, 3> mixed{};
  for (std::size_t k = 0; k < 3; ++k) {
    mixed[k] = static_cast<int>(
        std::lround(colours[half][k] + between * (colours[half + 1][k] - colours[half][k])));
  }
  return fmt::format("#{:02x}{:02x}{:02x}", mixed[0], mixed[1], mixed[2]);
}

double step_size(const FieldScale& scale) {
  return (scale.high - scale.low) / scale.steps;
}

int step_holding(double value, const FieldScale& scale) {
  const double place = std::floor((value - scale.low) / step_size(scale));
  return static_cast<int>(std::clamp(place, 0.0, static_cast<double>(scale.steps - 1)));
}

std::string colour_of_step(int step, const FieldScale& scale) {
  const double middle = scale.low + (step + 0.5) * step_size(scale);
  const double most = std::max(std::abs(scale.low), std::abs(scale.high));
  if (std::abs(middle) <= 0.5 * step_size(scale) * (1 + 1e-9)) return "#ffffff";
  return tone(middle > 0 ? kAbove : kBelow, std::min(1.0, std::abs(middle) / most));
}

}  // namespace

Status check_field(const Field& field) {
  const auto rise = [](double low, double high) {
    return std::isfinite(low) && std::isfinite(high) && low < high;
  };
  if (field.columns < 1 || field.rows < 1 || field.columns > kMaxCells || field.rows > kMaxCells ||
      field.values.size() !=
          static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows)) {
    return Error("plot-shape", fmt::format("invalid field: {} by {} cells, {} values",
                                           field.columns, field.rows, field.values.size()));
  }
  if (!rise(field.x_low, field.x_high) || !rise(field.y_low, field.y_high)) {
    return Error("plot-shape", "field edges must be finite and increasing");
  }
  return {};
}

// Steps of a round size, one of which is centred on zero.
FieldScale scale_of(const Field& field) {
  Range range;
  range.add(0, Scale::linear);
  for (const double value : field.values) range.add(value, Scale::linear);
  const auto [low, high] = range.settled(Scale::linear);
  const double step = tick_step(low, high, kColourSteps);
  const double below = std::floor(low / step + 0.5), above = std::floor(high / step + 0.5);
  return {(below - 0.5) * step, (above + 0.5) * step, static_cast<int>(above - below) + 1};
}

void write_field(const Field& field, const PlotArea& area, std::string& out) {
  const FieldScale scale = scale_of(field);
  const double width = (field.x_high - field.x_low) / field.columns;
  const double height = (field.y_high - field.y_low) / field.rows;
  // Crisp edges avoid thin seams between rectangles.
  out += field.faint ? "<g shape-rendering=\"crispEdges\" opacity=\"0.5\">\n"
                     : "<g shape-rendering=\"crispEdges\">\n";
  for (int row = 0; row < field.rows; ++row) {
    const double* values = field.values.data() +
                           static_cast<std::size_t>(row) * static_cast<std::size_t>(field.columns);
    const double top = area.at_y(field.y_low + (row + 1) * height);
    const double bottom = area.at_y(field.y_low + row * height);
    for (int first = 0; first < field.columns;) {
      int end = first + 1;
      if (!std::isfinite(values[first])) {
        first = end;
        continue;
      }
      const int step = step_holding(values[first], scale);
      while (end < field.columns && std::isfinite(values[end]) &&
             step_holding(values[end], scale) == step) {
        ++end;
      }
      const double left = area.at_x(field.x_low + first * width);
      const double right = area.at_x(field.x_low + end * width);
      out += fmt::format("<rect fill=\"{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
                         colour_of_step(step, scale), number(left), number(top),
                         number(right - left), number(bottom - top));
      first = end;
    }
  }
  out += "</g>\n";
}

double write_field_bar(const Field& field, double right, double bottom, std::string& out) {
  const FieldScale scale = scale_of(field);
  const double step = step_size(scale);
  // The labels are the centres of the outer steps, which are round numbers.
  const std::string low = tick_text(scale.low + step / 2, step, Scale::linear);
  const std::string high = tick_text(scale.high - step / 2, step, Scale::linear);
  const double end = right - text_width(high) - kTick;
  const double begin = end - scale.steps * kBarStep;
  out += field.faint ? "<g shape-rendering=\"crispEdges\" opacity=\"0.5\">"
                     : "<g shape-rendering=\"crispEdges\">";
  for (int k = 0; k < scale.steps; ++k) {
    out += fmt::format("<rect fill=\"{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
                       colour_of_step(k, scale), number(begin + k * kBarStep),
                       number(bottom - kBarHeight), number(kBarStep), number(kBarHeight));
  }
  out += fmt::format("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></g>\n",
                     number(begin), number(bottom - kBarHeight), number(end - begin),
                     number(kBarHeight));
  const double left = begin - kTick - text_width(low);
  out += fmt::format("<text x=\"{}\" y=\"{}\">{}</text><text x=\"{}\" y=\"{}\">{}</text>\n",
                     number(left), number(bottom), low, number(end + kTick), number(bottom), high);
  return left;
}

}  // namespace krok::draw
