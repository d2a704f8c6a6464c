#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "terrain/surface_lines_internal.h"

namespace krok::terrain {

namespace {

constexpr double kProbeSpacing = 0.1;  // metres between the first lines
constexpr int kMaxProbes = 200;        // lines across, at which a line's heights are read
constexpr double kFinest = 0.01;       // metres between lines where nothing jumps
constexpr double kLeastJump = 0.002;   // metres
constexpr int kLongestRun = 64;        // lines that may be left out in a row before one is tried

constexpr double kNone = std::numeric_limits<double>::infinity();

// Heights along one line; kNone where there is no ground.
using Heights = std::vector<double>;
using Sample = std::function<Heights(double)>;

struct Line {
  double at = 0;
  Heights heights;
};

std::vector<double> even(double low, double high, int count) {
  std::vector<double> places;
  for (int i = 0; i < count; ++i) places.push_back(low + (high - low) * i / (count - 1));
  places.back() = high;
  return places;
}

int count_of(double low, double high) {
  return 1 + std::clamp(static_cast<int>(std::ceil((high - low) / kProbeSpacing)), 1, kMaxProbes);
}

// Whether what is linear from `a` to `b` misses `between` by more than the tolerance.
bool misses(const Line& a, const Line& b, const Line& between, double tolerance) {
  const double share = (between.at - a.at) / (b.at - a.at);
  for (std::size_t i = 0; i < a.heights.size(); ++i) {
    const double one = a.heights[i], two = b.heights[i], real = between.heights[i];
    if (one == kNone && two == kNone && real == kNone) continue;
    if (one == kNone || two == kNone || real == kNone) return true;
    if (std::abs(one + share * (two - one) - real) > tolerance) return true;
  }
  return false;
}

// Whether the ground has an edge or a border between two lines so close that nothing else is.
bool jumps(const Line& a, const Line& b) {
  for (std::size_t i = 0; i < a.heights.size(); ++i) {
    const double one = a.heights[i], two = b.heights[i];
    if ((one == kNone) != (two == kNone)) return true;
    if (one != kNone && std::abs(two - one) > std::max(kLeastJump, 4 * (b.at - a.at))) return true;
  }
  return false;
}

class Lines {
 public:
  Lines(Sample sample, double tolerance) : sample_(std::move(sample)), tolerance_(tolerance) {}

  std::vector<double> between(double low, double high) {
    const std::vector<double> first =
        even(low, high, 1 + std::max(1, static_cast<int>(std::ceil((high - low) / kProbeSpacing))));
    lines_.push_back({first[0], sample_(first[0])});
    for (std::size_t i = 1; i < first.size(); ++i) {
      const Line before = lines_.back();
      refine(before, {first[i], sample_(first[i])});
    }
    return needed();
  }

 private:
  // Adds the lines after `a` up to `b`.
  void refine(const Line& a, const Line& b) {
    const double wide = b.at - a.at;
    if (wide > kJump / 2) {
      // Not in the middle, where a wave may be as it is at both ends.
      const Line middle = sampled(a.at + 0.47 * wide);
      const Line further = sampled(a.at + 0.78 * wide);
      const bool bent = misses(a, b, middle, tolerance_) || misses(a, b, further, tolerance_);
      if (bent && (wide > kFinest || jumps(a, b))) {
        refine(a, middle);
        refine(middle, b);
        return;
      }
    }
    lines_.push_back(b);
  }

  Line sampled(double at) const { return {at, sample_(at)}; }

  // Of the lines, those between which the others are linear.
  std::vector<double> needed() const {
    std::vector<double> kept = {lines_.front().at};
    std::size_t from = 0;
    while (from + 1 < lines_.size()) {
      std::size_t to = from + 1;
      while (to + 1 < lines_.size() && to + 1 - from <= kLongestRun && fits(from, to + 1)) ++to;
      kept.push_back(lines_[to].at);
      from = to;
    }
    return kept;
  }

  bool fits(std::size_t from, std::size_t to) const {
    // What is left out is linear far better than the tolerance, which was used up between lines.
    for (std::size_t k = from + 1; k < to; ++k) {
      if (misses(lines_[from], lines_[to], lines_[k], 0.2 * tolerance_)) return false;
    }
    return true;
  }

  Sample sample_;
  double tolerance_;
  std::vector<Line> lines_;
};

}  // namespace

SurfaceLines surface_lines(const Terrain& ground, const SurfaceOptions& options, double tolerance) {
  const Vec2 &low = options.low, &high = options.high;
  const auto height = [&](double x, double z) {
    const auto point = ground.at(x, z);
    return point ? point->height : kNone;
  };
  const std::vector<double> columns = even(low.x(), high.x(), count_of(low.x(), high.x()));
  const std::vector<double> rows = even(low.y(), high.y(), count_of(low.y(), high.y()));
  SurfaceLines lines;
  lines.x = Lines(
                [&](double x) {
                  Heights heights;
                  for (const double z : rows) heights.push_back(height(x, z));
                  return heights;
                },
                tolerance)
                .between(low.x(), high.x());
  lines.z = Lines(
                [&](double z) {
                  Heights heights;
                  for (const double x : columns) heights.push_back(height(x, z));
                  return heights;
                },
                tolerance)
                .between(low.y(), high.y());
  return lines;
}

}  // namespace krok::terrain
