#include "body/implicit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace krok::body {

namespace {

constexpr double kFar = std::numeric_limits<double>::max();
constexpr int kPieces = 5;  // linear segments of a spline between two stations

double cubic(double a, double b, double c, double d, double t) {
  return 0.5 *
         (2 * b + t * ((c - a) + t * ((2 * a - 5 * b + 4 * c - d) + t * (3 * (b - c) + d - a))));
}

Station mix(const Station& a, const Station& b, double t) {
  Station result;
  result.center = a.center + t * (b.center - a.center);
  result.width = a.width + t * (b.width - a.width);
  result.depth = a.depth + t * (b.depth - a.depth);
  result.side = a.side + t * (b.side - a.side);
  result.front = a.front + t * (b.front - a.front);
  result.cap = a.cap + t * (b.cap - a.cap);
  result.arc = a.arc + t * (b.arc - a.arc);
  result.along = a.along + t * (b.along - a.along);
  result.detail = a.detail + t * (b.detail - a.detail);
  return result;
}

// Orthonormalises side and front; side keeps its direction.
void square_up(Station& station) {
  const double side = station.side.norm();
  station.side = side > 1e-9 ? Vec3(station.side / side) : Vec3(Vec3::UnitX());
  station.front -= station.side * station.side.dot(station.front);
  double front = station.front.norm();
  if (front < 1e-6) {
    const Vec3 other = std::abs(station.side.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitZ();
    station.front = other.cross(station.side);
    front = station.front.norm();
  }
  station.front /= front;
}

std::vector<Station> smooth_path(const Tube& tube) {
  const auto& in = tube.stations;
  std::vector<Station> out;
  for (std::size_t i = 0; i + 1 < in.size(); ++i) {
    const Station& b = in[i];
    const Station& c = in[i + 1];
    const Station& a = in[i > 0 ? i - 1 : i];
    const Station& d = in[std::min(i + 2, in.size() - 1)];
    const int pieces = tube.spline ? kPieces : 1;
    for (int k = 0; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      Station station = mix(b, c, t);
      if (tube.spline) {
        for (int axis = 0; axis < 3; ++axis) {
          station.center[axis] =
              cubic(a.center[axis], b.center[axis], c.center[axis], d.center[axis], t);
        }
        const double low = 0.8 * std::min(b.width, c.width);
        station.width = std::max(cubic(a.width, b.width, c.width, d.width, t), low);
        const double thin = 0.8 * std::min(b.depth, c.depth);
        station.depth = std::max(cubic(a.depth, b.depth, c.depth, d.depth, t), thin);
        if (b.cap == b.width && c.cap == c.width) station.cap = station.width;
      }
      out.push_back(station);
    }
  }
  out.push_back(in.back());
  for (Station& station : out) {
    square_up(station);
    if (station.cap <= 0) station.cap = std::min(station.width, station.depth);
  }
  return out;
}

// Smooth minimum of two distances (quadratic polynomial): differs from the minimum only where they
// are within k of each other.
double smooth_min(double a, double b, double k) {
  const double h = k - std::abs(a - b);
  return std::min(a, b) - (h > 0 ? h * h / (4 * k) : 0.0);
}

double reach(const Station& station) {
  return std::max({station.width, station.depth, station.cap});
}

}  // namespace

Field::Field(const Shape& shape) : blends_(shape.blends) {
  smallest_radius_ = std::numeric_limits<double>::max();
  const std::size_t count = shape.tubes.size();
  for (const Tube& tube : shape.tubes) {
    Path path{smooth_path(tube), {}, tube.cuts, tube.joints, 0};
    for (std::size_t i = 0; i + 1 < std::max<std::size_t>(path.stations.size(), 2); ++i) {
      const Station& a = path.stations[i];
      const Station& b = path.stations[std::min(i + 1, path.stations.size() - 1)];
      path.balls.push_back({0.5 * (a.center + b.center),
                            0.5 * (b.center - a.center).norm() + std::max(reach(a), reach(b))});
    }
    for (std::size_t i = 0; i < path.stations.size(); ++i) {
      const Station& s = path.stations[i];
      const Vec3 r = Vec3::Constant(reach(s));
      bounds_.extend(s.center - r);
      bounds_.extend(s.center + r);
      smallest_radius_ = std::min({smallest_radius_, s.width, s.depth});
      if (i > 0) {
        const Station& p = path.stations[i - 1];
        area_ +=
            2 * kPi * 0.25 * (s.width + s.depth + p.width + p.depth) * (s.center - p.center).norm();
      }
    }
    const Station& first = path.stations.front();
    const Station& last = path.stations.back();
    area_ += 2 * kPi * (first.width * first.depth + last.width * last.depth) / 2;
    paths_.push_back(std::move(path));
  }
  pair_radius_.assign(count, std::vector<double>(count, 0.0));
  double margin = 0;
  for (const Blend& blend : blends_) {
    margin = std::max(margin, blend.radius);
    for (const int a : blend.tubes) {
      double& own = paths_[static_cast<std::size_t>(a)].margin;
      own = std::max(own, blend.radius);
      for (const int b : blend.tubes) {
        double& radius = pair_radius_[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
        radius = std::max(radius, blend.radius);
      }
    }
  }
  bounds_.extend(bounds_.min() - Vec3::Constant(margin));
  bounds_.extend(bounds_.max() + Vec3::Constant(margin));
}

Field::Near Field::near(const Vec3& center, double radius) const {
  Near near;
  std::vector<char> present(paths_.size(), 0);
  for (std::size_t t = 0; t < paths_.size(); ++t) {
    const auto& balls = paths_[t].balls;
    const int segments = static_cast<int>(balls.size());
    int first = segments, last = -1;
    for (int s = 0; s < segments; ++s) {
      const Ball& ball = balls[static_cast<std::size_t>(s)];
      if ((ball.center - center).norm() > radius + ball.radius + 1.5 * paths_[t].margin) continue;
      first = std::min(first, s);
      last = std::max(last, s);
    }
    if (last < 0) continue;
    near.ranges.push_back({static_cast<int>(t), first, last});
    present[t] = 1;
  }
  for (std::size_t b = 0; b < blends_.size(); ++b) {
    int members = 0;
    for (const int tube : blends_[b].tubes) members += present[static_cast<std::size_t>(tube)];
    if (members > 1) near.blends.push_back(static_cast<int>(b));
  }
  return near;
}

double Field::segment_value(const Path& path, int segment, const Vec3& point,
                            double* fraction) const {
  const auto i = static_cast<std::size_t>(segment);
  const Station& a = path.stations[i];
  const Station& b = path.stations[std::min(i + 1, path.stations.size() - 1)];
  const Vec3 axis = b.center - a.center;
  const double length2 = axis.squaredNorm();
  double t = length2 > 0 ? (point - a.center).dot(axis) / length2 : 0.0;
  t = std::clamp(t, 0.0, 1.0);
  *fraction = t;
  const Vec3 q = point - (a.center + t * axis);
  // Round at both ends: no frame is needed, which in general shapes may rotate between them.
  if (a.width == a.depth && a.width == a.cap && b.width == b.depth && b.width == b.cap) {
    return q.norm() - (a.width + t * (b.width - a.width));
  }
  // The frames of neighbouring stations differ little: the interpolated one is nearly orthonormal.
  const Vec3 side = a.side + t * (b.side - a.side);
  const Vec3 front = a.front + t * (b.front - a.front);
  const double width = a.width + t * (b.width - a.width);
  const double depth = a.depth + t * (b.depth - a.depth);
  const double cap = a.cap + t * (b.cap - a.cap);
  const Vec3 curved(1 / width, 1 / depth, 1 / cap);
  const Vec3 scaled =
      Vec3(q.dot(side), q.dot(front), q.dot(side.cross(front))).cwiseProduct(curved);
  const double k0 = scaled.norm();
  const double k1 = scaled.cwiseProduct(curved).norm();
  const double smallest = std::min({width, depth, cap});
  // First-order distance to an ellipsoid; near its centre, where that breaks down, a bound.
  if (k0 < 0.3) return (k0 - 1) * smallest;
  return k0 * (k0 - 1) / k1;
}

double Field::tube_value(int tube, int first, int last, const Vec3& point, double limit,
                         int* segment, double* fraction) const {
  const Path& path = paths_[static_cast<std::size_t>(tube)];
  // Starts with the segment whose midpoint is nearest, so that most others can be rejected.
  int start = first;
  double shortest = std::numeric_limits<double>::max();
  bool within = false;
  const double beyond = std::max(limit, 0.0);
  for (int s = first; s <= last; ++s) {
    const Ball& ball = path.balls[static_cast<std::size_t>(s)];
    const double away = (ball.center - point).squaredNorm(), bound = ball.radius + beyond;
    if (away < shortest) shortest = away, start = s;
    within = within || away <= bound * bound;
  }
  if (!within) return kFar;
  double t = 0;
  double best = segment_value(path, start, point, &t);
  if (segment) *segment = start;
  if (fraction) *fraction = t;
  for (int s = first; s <= last; ++s) {
    if (s == start) continue;
    const Ball& ball = path.balls[static_cast<std::size_t>(s)];
    const double bound = ball.radius + std::max(best, 0.0);
    if ((ball.center - point).squaredNorm() > bound * bound) continue;
    const double value = segment_value(path, s, point, &t);
    if (value >= best) continue;
    best = value;
    if (segment) *segment = s;
    if (fraction) *fraction = t;
  }
  for (const Cut& cut : path.cuts) {
    const double outside = cut.normal.dot(point) - cut.offset;
    best = cut.blend > 0 ? -smooth_min(-best, -outside, cut.blend) : std::max(best, outside);
  }
  return best;
}

double Field::value(const Vec3& point, const Near& near) const {
  constexpr std::size_t kMax = 64;
  std::array<double, kMax> few;
  std::vector<double> many;
  double* values = few.data();
  if (near.ranges.size() > kMax) {
    many.resize(near.ranges.size());
    values = many.data();
  }
  double result = kFar;
  for (std::size_t i = 0; i < near.ranges.size(); ++i) {
    const Near::Range& range = near.ranges[i];
    const double limit = limit_of(range.tube, result);
    values[i] = tube_value(range.tube, range.first, range.last, point, limit, nullptr, nullptr);
    result = std::min(result, values[i]);
  }
  for (const int index : near.blends) {
    const Blend& blend = blends_[static_cast<std::size_t>(index)];
    // Blends members one by one, nearest first: the result does not depend on the order of the
    // list, and is continuous where two members swap, since their values are equal there.
    std::array<double, 16> members;
    std::size_t count = 0;
    double nearest = std::numeric_limits<double>::max();
    for (const int tube : blend.tubes) {
      for (std::size_t i = 0; i < near.ranges.size() && count < members.size(); ++i) {
        if (near.ranges[i].tube != tube) continue;
        members[count++] = values[i];
        nearest = std::min(nearest, values[i]);
      }
    }
    if (count < 2 || nearest > result + blend.radius) continue;
    std::sort(members.begin(), members.begin() + static_cast<std::ptrdiff_t>(count));
    double blended = members[0];
    for (std::size_t i = 1; i < count; ++i) {
      blended = smooth_min(blended, members[i], blend.radius);
    }
    result = std::min(result, blended);
  }
  return result;
}

double Field::limit_of(int tube, double nearest) const {
  // Beyond what it blends with; the rest is for values below the distance, see segment_value().
  return nearest + 1.5 * paths_[static_cast<std::size_t>(tube)].margin;
}

Vec3 Field::gradient(const Vec3& point, double value_there, const Near& near, double step) const {
  Vec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 ahead = point;
    ahead[axis] += step;
    result[axis] = (value(ahead, near) - value_there) / step;
  }
  return result;
}

TubePoint Field::nearest_place(const Vec3& point, const Near& near) const {
  TubePoint nearest;
  nearest.tube = -1;
  for (const Near::Range& range : near.ranges) {
    TubePoint place;
    place.tube = range.tube;
    const double limit = nearest.tube < 0 ? kFar : limit_of(range.tube, nearest.value);
    place.value = tube_value(range.tube, range.first, range.last, point, limit, &place.segment,
                             &place.fraction);
    if (nearest.tube < 0 || place.value < nearest.value) nearest = place;
  }
  return nearest;
}

std::vector<TubePoint> Field::places(const Vec3& point, const Near& near) const {
  std::vector<TubePoint> places;
  for (const Near::Range& range : near.ranges) {
    TubePoint place;
    place.tube = range.tube;
    place.segment = range.first;
    place.value = tube_value(range.tube, range.first, range.last, point, kFar, &place.segment,
                             &place.fraction);
    places.push_back(place);
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const TubePoint& a, const TubePoint& b) { return a.value < b.value; });
  return places;
}

Station Field::station_at(const TubePoint& place) const {
  const auto& stations = paths_[static_cast<std::size_t>(place.tube)].stations;
  const auto i = static_cast<std::size_t>(place.segment);
  Station station =
      mix(stations[i], stations[std::min(i + 1, stations.size() - 1)], place.fraction);
  square_up(station);
  return station;
}

double Field::detail_at(const TubePoint& place) const {
  const auto& stations = paths_[static_cast<std::size_t>(place.tube)].stations;
  const auto i = static_cast<std::size_t>(place.segment);
  const double from = stations[i].detail;
  return from + place.fraction * (stations[std::min(i + 1, stations.size() - 1)].detail - from);
}

void Field::bind(const TubePoint& place, double scale,
                 std::vector<std::pair<int, double>>& weights) const {
  const Path& path = paths_[static_cast<std::size_t>(place.tube)];
  const double arc = station_at(place).arc;
  double reached = 1;  // fade-in of joint i
  for (std::size_t i = 0; i < path.joints.size(); ++i) {
    double next = 0;
    if (i + 1 < path.joints.size()) {
      const TubeJoint& follower = path.joints[i + 1];
      const double width = std::max(follower.half_width, 1e-12);
      const double x = std::clamp(0.5 + 0.5 * (arc - follower.at) / width, 0.0, 1.0);
      next = std::min(reached, x * x * (3 - 2 * x));
    }
    if (reached > next) weights.emplace_back(path.joints[i].joint, scale * (reached - next));
    reached = next;
  }
}

bool Field::blended(int tube_a, int tube_b) const {
  return blend_radius(tube_a, tube_b) > 0;
}

double Field::blend_radius(int tube_a, int tube_b) const {
  return pair_radius_[static_cast<std::size_t>(tube_a)][static_cast<std::size_t>(tube_b)];
}

std::vector<Field::Ball> Field::balls() const {
  std::vector<Ball> balls;
  for (const Path& path : paths_) {
    for (const Ball& ball : path.balls) balls.push_back({ball.center, ball.radius + path.margin});
  }
  return balls;
}

}  // namespace krok::body
