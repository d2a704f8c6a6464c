#include "ragdoll/overlaps.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/index.h"

namespace krok::ragdoll {

double signed_distance(const Shape& shape, const Vec3& point) {
  if (shape.kind == Shape::Kind::box) {
    const Vec3 beyond = point.cwiseAbs() - shape.half;
    return beyond.cwiseMax(0).norm() + std::min(0.0, beyond.maxCoeff());
  }
  const double along = std::clamp(point.y(), -shape.half_length, shape.half_length);
  return (point - Vec3(0, along, 0)).norm() - shape.radius;
}

namespace {

constexpr double kPause = 0.25;  // seconds

// A segment along an axis of the body, and the radius around it that is in the shape.
struct Core {
  Vec3 end = Vec3::Zero();  // the other one is -end
  double radius = 0;
};

Core core_of(const Shape& shape) {
  if (shape.kind != Shape::Kind::box) return {{0, shape.half_length, 0}, shape.radius};
  int longest = 0;
  shape.half.maxCoeff(&longest);
  Core core;
  core.radius = shape.half.minCoeff();
  core.end[longest] = shape.half[longest] - core.radius;
  return core;
}

// How deep the core of `inner` is in `outer`; negative: how far apart they are.
double depth_in(const Shape& outer, const Shape& inner, const Transform& inner_to_outer) {
  constexpr int kParts = 8;
  const Core core = core_of(inner);
  double nearest = HUGE_VAL;
  for (int k = 0; k <= kParts; ++k) {
    const Vec3 point = (2.0 * k / kParts - 1) * core.end;
    nearest = std::min(nearest, signed_distance(outer, inner_to_outer * point));
  }
  return core.radius - nearest;
}

double reach_of(const Shape& shape) {
  return shape.kind == Shape::Kind::box ? shape.half.norm() : shape.radius + shape.half_length;
}

double depth_of(const Body& a, const Transform& a_to_world, const Body& b,
                const Transform& b_to_world) {
  if ((a_to_world.position - b_to_world.position).norm() > reach_of(a.shape) + reach_of(b.shape)) {
    return 0;
  }
  const Transform b_to_a = a_to_world.inverse() * b_to_world;
  return std::max(
      {0.0, depth_in(a.shape, b.shape, b_to_a), depth_in(b.shape, a.shape, b_to_a.inverse())});
}

}  // namespace

std::vector<Overlap> find_overlaps(const Clip& clip, const std::vector<Body>& bodies,
                                   double limit) {
  struct Pair {
    int a, b;
    double at_rest;
    Overlap open;  // depth 0: none
  };
  const auto place = [](const Body& body, const Transform& joint_to_world) {
    return joint_to_world * body.to_joint;
  };
  const auto& reference = clip.skeleton.reference;
  std::vector<Pair> pairs;
  for (int a = 0; a < std::ssize(bodies); ++a) {
    for (int b = a + 1; b < std::ssize(bodies); ++b) {
      const Body &first = bodies[at(a)], &second = bodies[at(b)];
      if (second.parent == a || second.parent == first.parent) continue;
      pairs.push_back({a,
                       b,
                       depth_of(first, place(first, reference[at(first.joint)]), second,
                                place(second, reference[at(second.joint)])),
                       {}});
    }
  }
  std::vector<Overlap> found;
  const double apart = kPause * clip.rate;  // frames
  std::vector<Transform> places(bodies.size());
  const auto close = [&](Pair& pair) {
    if (pair.open.depth > 0) found.push_back(pair.open);
    pair.open = {};
  };
  for (int f = 0; f < clip.frame_count(); ++f) {
    const std::size_t row = at(f) * at(clip.joint_count());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const std::size_t j = row + at(bodies[i].joint);
      places[i] =
          place(bodies[i], {clip.positions[j].cast<double>(), clip.orientations[j].cast<double>()});
    }
    for (Pair& pair : pairs) {
      const double depth =
          depth_of(bodies[at(pair.a)], places[at(pair.a)], bodies[at(pair.b)], places[at(pair.b)]) -
          pair.at_rest;
      if (depth <= limit) {
        if (f > pair.open.last_frame + apart) close(pair);
        continue;
      }
      if (pair.open.depth == 0) pair.open = {pair.a, pair.b, f, f, f, 0};
      pair.open.last_frame = f;
      if (depth > pair.open.depth) pair.open.depth = depth, pair.open.worst = f;
    }
  }
  for (Pair& pair : pairs) close(pair);
  std::ranges::stable_sort(found, [](const Overlap& x, const Overlap& y) {
    return std::tuple(x.first, x.second, x.first_frame) <
           std::tuple(y.first, y.second, y.first_frame);
  });
  return found;
}

}  // namespace krok::ragdoll
