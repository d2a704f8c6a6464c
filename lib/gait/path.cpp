#include "gait/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"

namespace krok::gait {

namespace {

constexpr double kShortestPath = 0.05, kLongestPath = 1e6, kFarthestPoint = 1e6;
constexpr double kSamePoint = 1e-6;
constexpr double kPathSpacing = 0.02;
constexpr double kWayStep = 0.1;  // metres between points of a motion's way
constexpr double kMaxPathSamples = 4e6;

double heading_of(const Vec2& way) {
  return std::atan2(way.x(), way.y());
}

// The segment of a table of rising values that `value` lies in.
std::size_t segment_of(std::span<const double> rising, double value) {
  const auto above = std::upper_bound(rising.begin() + 1, rising.end() - 1, value);
  return static_cast<std::size_t>(above - rising.begin()) - 1;
}

}  // namespace

Result<Path> Path::create(std::span<const PathPoint> points, double heading_window) {
  Path path;
  double latest = -1e300;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PathPoint& point = points[i];
    const bool possible = std::abs(point.x) <= kFarthestPoint &&
                          std::abs(point.z) <= kFarthestPoint &&
                          std::isfinite(point.time.value_or(0));
    if (!possible) {
      return Error("path-value",
                   fmt::format("point {} of the path is at ({}, {}) m", i + 1, point.x, point.z));
    }
    const Vec2 place(point.x, point.z);
    const double step = path.points_.empty() ? 0 : (place - path.points_.back()).norm();
    if (path.points_.empty() || step > kSamePoint) {
      path.length_ += step;
      path.points_.push_back(place);
      path.lengths_.push_back(path.length_);
    }
    if (!point.time) continue;
    if (*point.time <= latest) {
      return Error("path-times",
                   fmt::format("point {} of the path is at {} s, not after {} s", i + 1,
                               readable(*point.time), readable(latest)),
                   "times must rise");
    }
    latest = *point.time;
    // Only the end of a pause counts: footprints do not wait.
    if (!path.timed_lengths_.empty() && path.timed_lengths_.back() >= path.length_) {
      path.times_.back() = latest;
      continue;
    }
    path.times_.push_back(latest);
    path.timed_lengths_.push_back(path.length_);
  }
  if (!(path.length_ >= kShortestPath)) {
    return Error("path-short", fmt::format("the path is {} m long", readable(path.length_)),
                 "give a path of at least 5 cm");
  }
  if (path.length_ > kLongestPath) {
    return Error("path-long", fmt::format("the path is {} m long", readable(path.length_)),
                 "check its unit");
  }
  path.sample_headings(heading_window);
  return path;
}

Vec2 Path::point_at(double length, std::size_t& segment) const {
  while (segment + 2 < lengths_.size() && lengths_[segment + 1] < length) ++segment;
  while (segment > 0 && lengths_[segment] > length) --segment;
  const double part = (length - lengths_[segment]) / (lengths_[segment + 1] - lengths_[segment]);
  return points_[segment] + part * (points_[segment + 1] - points_[segment]);
}

void Path::sample_headings(double window) {
  spacing_ = std::max(kPathSpacing, length_ / kMaxPathSamples);
  const auto count = static_cast<std::size_t>(std::ceil(length_ / spacing_)) + 1;
  headings_.resize(count);
  std::size_t behind = 0, ahead = 0;
  double last = heading_of(points_[1] - points_[0]);
  for (std::size_t i = 0; i < count; ++i) {
    const double at = std::min(length_, static_cast<double>(i) * spacing_);
    const double half = std::max(0.5 * kPathSpacing, std::min({0.5 * window, at, length_ - at}));
    const double from = std::clamp(at - half, 0.0, length_ - kPathSpacing);
    const double to = std::clamp(at + half, kPathSpacing, length_);
    const Vec2 chord = point_at(to, ahead) - point_at(from, behind);
    // On the point where a way turns back there is no chord; the next one turns.
    if (chord.norm() > 1e-3 * (to - from)) {
      last += std::remainder(heading_of(chord) - last, 2 * kPi);
    }
    headings_[i] = last;
  }
}

PathPlace Path::at(double length) const {
  length = std::clamp(length, 0.0, length_);
  PathPlace place;
  std::size_t segment = segment_of(lengths_, length);
  const Vec2 point = point_at(length, segment);
  place.x = point.x();
  place.z = point.y();
  const auto sample = std::min(static_cast<std::size_t>(length / spacing_), headings_.size() - 2);
  const double begin = static_cast<double>(sample) * spacing_;
  const double width = std::min(spacing_, std::max(length_ - begin, 1e-9));
  place.curvature = (headings_[sample + 1] - headings_[sample]) / width;
  place.heading = headings_[sample] + place.curvature * std::min(length - begin, width);
  if (times_.size() > 1 && length >= timed_lengths_.front() && length <= timed_lengths_.back()) {
    const std::size_t k = segment_of(timed_lengths_, length);
    const double part = (length - timed_lengths_[k]) / (timed_lengths_[k + 1] - timed_lengths_[k]);
    place.time = times_[k] + part * (times_[k + 1] - times_[k]);
  }
  return place;
}

std::vector<PathPoint> way_to_goals(double x, double z, double heading, std::span<const Vec2> goals,
                                    double radius) {
  std::vector<PathPoint> way = {{x, z, {}}};
  Vec2 here(x, z);
  for (const Vec2& goal : goals) {
    const Vec2 to_goal = goal - here;
    const double far = to_goal.norm();
    if (!(far > 1e-3)) continue;
    const Vec2 ahead(std::sin(heading), std::cos(heading));
    const double bearing = std::remainder(heading_of(to_goal) - heading, 2 * kPi);
    const double side = bearing < 0 ? -1 : 1;  // positive: towards +X, that is to the left
    // The circle that leaves along the heading and meets the goal has this radius; a smaller one
    // leaves room for the straight way after it.
    const double through = far / (2 * std::max(std::abs(std::sin(bearing)), 1e-9));
    const double arc_radius = std::min(radius, 0.45 * through);
    const Vec2 centre = here + side * arc_radius * Vec2(ahead.y(), -ahead.x());
    const Vec2 from_centre = goal - centre;
    // The tangent from the goal touches the circle where the radius is at this angle to it.
    const double apex = std::acos(std::clamp(arc_radius / from_centre.norm(), -1.0, 1.0));
    const double out = heading_of(from_centre) - side * apex;  // heading of the touching radius
    const double begin = heading_of(here - centre);
    double sweep = side * (out - begin);
    sweep -= 2 * kPi * std::floor(sweep / (2 * kPi));
    if (sweep > 2 * kPi - 1e-9) sweep = 0;
    const int pieces = std::max(1, static_cast<int>(std::ceil(sweep / 0.05)));
    for (int i = 1; i <= pieces && sweep > 1e-9; ++i) {
      const double angle = begin + side * sweep * i / pieces;
      const Vec2 point = centre + arc_radius * Vec2(std::sin(angle), std::cos(angle));
      way.push_back({point.x(), point.y(), {}});
    }
    way.push_back({goal.x(), goal.y(), {}});
    heading += side * sweep;
    here = goal;
  }
  return way;
}

std::vector<PathPoint> way_of(const Clip& clip, int joint, double window) {
  const int count = clip.frame_count();
  // Running sums of places; averaged twice, because one average leaves a ripple if strides are not
  // as long as the window.
  std::vector<Vec2> places(static_cast<std::size_t>(count));
  for (int frame = 0; frame < count; ++frame) {
    const Vec3f position = clip.frame_positions(frame)[static_cast<std::size_t>(joint)];
    places[static_cast<std::size_t>(frame)] = {position.x(), position.z()};
  }
  const int reach = static_cast<int>(std::lround(0.5 * window * clip.rate));
  for (int round = 0; round < 2; ++round) {
    std::vector<Vec2> sums(places.size() + 1, Vec2::Zero());
    for (std::size_t i = 0; i < places.size(); ++i) sums[i + 1] = sums[i] + places[i];
    for (int i = 0; i < count; ++i) {
      const int half = std::min({reach, i, count - 1 - i});
      const auto from = static_cast<std::size_t>(i - half), to = static_cast<std::size_t>(i + half);
      places[static_cast<std::size_t>(i)] =
          (sums[to + 1] - sums[from]) / static_cast<double>(2 * half + 1);
    }
  }
  // While a character stands about, only its place counts.
  std::vector<PathPoint> way;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const bool last = i + 1 == places.size();
    if (!way.empty()) {
      const Vec2 kept(way.back().x, way.back().z);
      if ((places[i] - kept).norm() < kWayStep) {
        if (!last || way.size() < 2) continue;
        way.pop_back();
      }
    }
    way.push_back({places[i].x(), places[i].y(), {}});
  }
  return way;
}

}  // namespace krok::gait
