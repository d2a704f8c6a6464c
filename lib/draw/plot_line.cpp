#include "draw/plot_line_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "draw/plot_style_internal.h"
#include "draw/svg_text_internal.h"

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

}  // namespace krok::draw
