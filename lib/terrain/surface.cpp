#include "terrain/surface.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "terrain/shapes.h"

namespace krok::terrain {

namespace {

// The lines on which a ground is sampled.

// Where along X and Z a ground is to be sampled so that what is linear between the lines misses it
// by no more than about `tolerance`. A jump has a line on either side, closer than kJump.
struct SurfaceLines {
  std::vector<double> x, z;  // rising, at least two
};

constexpr double kJump = 2e-6;  // metres

constexpr double kProbeSpacing = 0.1;  // metres between the first lines
constexpr int kMaxProbes = 200;        // lines across, at which a line's heights are read
constexpr double kFinest = 0.01;       // metres between lines where nothing jumps
constexpr double kMinJump = 0.002;     // metres
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
    if (one != kNone && std::abs(two - one) > std::max(kMinJump, 4 * (b.at - a.at))) return true;
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

const double kEdge = std::cos(30 * kRadiansPerDegree);  // faces that meet at more have an edge
constexpr double kLargestSize = 1e5;                    // metres along an axis
constexpr std::size_t kManyFaces = 64;  // round a corner: more are not compared one by one

// Corners that faces share.
struct Faces {
  std::vector<Vec3> corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Cuts a polygon at a plane across `axis`: what is beyond `limit` in the direction of `sign` goes.
std::vector<Vec3> cut(const std::vector<Vec3>& polygon, int axis, double limit, double sign) {
  std::vector<Vec3> left;
  const auto inside = [&](const Vec3& point) { return sign * (point[axis] - limit) <= 0; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    if (inside(a)) left.push_back(a);
    if (inside(a) == inside(b)) continue;
    // From the same end both ways, so that neighbours are cut at the same point.
    const bool turned = b[axis] < a[axis];
    const Vec3 &from = turned ? b : a, &to = turned ? a : b;
    Vec3 point = from + (limit - from[axis]) / (to[axis] - from[axis]) * (to - from);
    point[axis] = limit;
    left.push_back(point);
  }
  return left;
}

// The mesh within the rectangle; equal corners are one. Empty if that is more than the limit.
std::optional<Faces> faces_within(const std::vector<GroundTriangle>& triangles,
                                  const SurfaceOptions& options) {
  struct Before {
    bool operator()(const Vec3f& a, const Vec3f& b) const {
      return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
    }
  };
  Faces faces;
  std::map<Vec3f, std::uint32_t, Before> numbers;
  const auto number = [&](const Vec3& corner) {
    const auto [place, is_new] =
        numbers.try_emplace(corner.cast<float>(), static_cast<std::uint32_t>(faces.corners.size()));
    if (is_new) faces.corners.push_back(corner);
    return place->second;
  };
  for (const GroundTriangle& triangle : triangles) {
    std::vector<Vec3> polygon(triangle.begin(), triangle.end());
    const std::array limits = {std::pair{options.low.x(), options.high.x()},
                               std::pair{options.low.y(), options.high.y()}};
    for (int k = 0; k < 2; ++k) {
      const auto [low, high] = limits[static_cast<std::size_t>(k)];
      polygon = cut(polygon, 2 * k, low, -1);
      polygon = cut(polygon, 2 * k, high, 1);
    }
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      const std::array corners = {number(polygon[0]), number(polygon[i - 1]), number(polygon[i])};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
        continue;
      faces.triangles.push_back(corners);
    }
    if (static_cast<std::int64_t>(faces.triangles.size()) > 4 * options.triangles) return {};
  }
  return faces;
}

Faces faces_between(const Terrain& ground, const SurfaceLines& lines) {
  Faces faces;
  constexpr std::uint32_t kHole = ~std::uint32_t{0};
  std::vector<std::uint32_t> numbers;
  for (const double z : lines.z) {
    for (const double x : lines.x) {
      const auto point = ground.at(x, z);
      numbers.push_back(point ? static_cast<std::uint32_t>(faces.corners.size()) : kHole);
      if (point) faces.corners.emplace_back(x, point->height, z);
    }
  }
  const std::size_t columns = lines.x.size();
  for (std::size_t r = 0; r + 1 < lines.z.size(); ++r) {
    for (std::size_t c = 0; c + 1 < columns; ++c) {
      const std::uint32_t* at = &numbers[r * columns + c];
      const std::array corners = {at[0], at[columns], at[columns + 1], at[1]};
      if (std::ranges::max(corners) == kHole) continue;
      faces.triangles.push_back({corners[0], corners[1], corners[2]});
      faces.triangles.push_back({corners[0], corners[2], corners[3]});
    }
  }
  return faces;
}

// Splits corners at edges and gives each its normal: of the faces round it, weighted by area, that
// do not form an edge with the face it belongs to.
Surface shaded(const Faces& faces) {
  std::vector<Vec3> weighted;  // normals by area
  std::vector<std::vector<std::uint32_t>> round(faces.corners.size());
  for (const auto& corners : faces.triangles) {
    const Vec3& a = faces.corners[corners[0]];
    for (const std::uint32_t corner : corners) {
      round[corner].push_back(static_cast<std::uint32_t>(weighted.size()));
    }
    weighted.push_back((faces.corners[corners[1]] - a).cross(faces.corners[corners[2]] - a));
  }
  Surface surface;
  std::vector<std::vector<std::uint32_t>> copies(faces.corners.size());
  for (std::size_t f = 0; f < weighted.size(); ++f) {
    const double area = weighted[f].norm();
    if (!(area > 0)) continue;
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = faces.triangles[f][k];
      Vec3 sum = Vec3::Zero();
      for (const std::uint32_t other : round[corner]) {
        if (round[corner].size() > kManyFaces && other != f) continue;
        if (weighted[other].dot(weighted[f]) >= kEdge * weighted[other].norm() * area) {
          sum += weighted[other];
        }
      }
      const Vec3f normal = sum.normalized().cast<float>();
      const auto same = std::ranges::find_if(copies[corner], [&](std::uint32_t copy) {
        return (surface.normals[copy] - normal).squaredNorm() < 1e-6F;
      });
      if (same != copies[corner].end()) {
        triangle[k] = *same;
        continue;
      }
      triangle[k] = static_cast<std::uint32_t>(surface.positions.size());
      if (round[corner].size() <= kManyFaces) copies[corner].push_back(triangle[k]);
      surface.positions.push_back(faces.corners[corner].cast<float>());
      surface.normals.push_back(normal);
    }
    surface.triangles.push_back(triangle);
  }
  return surface;
}

}  // namespace

Result<Surface> surface_of(const Terrain& ground, const SurfaceOptions& options) {
  const Vec2 size = options.high - options.low;
  if (!size.allFinite() || !(size.minCoeff() > 0) || size.maxCoeff() > kLargestSize) {
    return Error("ground-value", "the part of the ground to be shown has no size");
  }
  std::optional<Faces> faces;
  if (const auto triangles = triangles_of(ground)) faces = faces_within(*triangles, options);
  for (double tolerance = options.tolerance; !faces; tolerance *= 4) {
    const SurfaceLines lines = surface_lines(ground, options, tolerance);
    const auto cells = static_cast<std::int64_t>((lines.x.size() - 1) * (lines.z.size() - 1));
    if (2 * cells <= options.triangles || tolerance > 1e6) faces = faces_between(ground, lines);
  }
  if (faces->triangles.empty()) {
    return Error("ground-empty", "there is no ground where the motion is",
                 "give the ground that the motion was made for");
  }
  return shaded(*faces);
}

}  // namespace krok::terrain
