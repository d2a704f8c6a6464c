#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "core/parallel.h"
#include "math/hermite.h"
#include "scene/frame_source.h"
#include "settle/settler_internal.h"

namespace krok::settling {

namespace {

constexpr double kSpacing = 0.08;  // metres, at most, between points of a side
constexpr double kEdge = 0.01;     // radius of the edges of boxes
constexpr int kDirections = 80;

int parts_of(double length) {
  return std::max(1, static_cast<int>(std::ceil(length / kSpacing)));
}

void add_capsule(const ragdoll::Body& body, int index, std::vector<SupportPoint>& points) {
  const ragdoll::Shape& shape = body.shape;
  const double half = shape.kind == ragdoll::Shape::Kind::capsule ? shape.half_length : 0;
  const int parts = half > 0 ? parts_of(2 * half) : 0;
  for (int i = 0; i <= parts; ++i) {
    const double along = parts > 0 ? half * (2.0 * i / parts - 1) : 0;
    points.push_back({index, body.to_joint * Vec3(0, along, 0), shape.radius});
  }
}

void add_box(const ragdoll::Body& body, int index, std::vector<SupportPoint>& points) {
  const Vec3& half = body.shape.half;
  const double radius = std::min(kEdge, 0.5 * half.minCoeff());
  const Vec3 inner = half - Vec3::Constant(radius);
  Eigen::Vector3i parts;
  for (int axis = 0; axis < 3; ++axis) parts[axis] = parts_of(2 * inner[axis]);
  for (int i = 0; i <= parts.x(); ++i) {
    for (int j = 0; j <= parts.y(); ++j) {
      for (int k = 0; k <= parts.z(); ++k) {
        const Eigen::Vector3i step(i, j, k);
        if (((step.array() > 0) && (step.array() < parts.array())).all()) continue;  // inside
        const Vec3 share = step.cast<double>().cwiseQuotient(parts.cast<double>());
        const Vec3 at_side = inner.cwiseProduct(2 * share - Vec3::Ones());
        points.push_back({index, body.to_joint * at_side, radius});
      }
    }
  }
}

// Evenly spread over the sphere (Fibonacci's spiral).
Vec3 direction(int i) {
  const double y = 1 - (2 * i + 1.0) / kDirections, turn = i * kPi * (3 - std::sqrt(5.0));
  const double across = std::sqrt(1 - y * y);
  return {across * std::cos(turn), y, across * std::sin(turn)};
}

void add_vertices(const std::vector<ragdoll::Body>& bodies, const Model& model,
                  std::vector<SupportPoint>& points) {
  const std::vector<int> carrier = ragdoll::body_of_joint(model.skeleton, bodies);
  const auto influences = static_cast<std::size_t>(model.influences_per_vertex);
  std::vector<std::vector<Vec3>> places(bodies.size());
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    const int body = carrier[at(model.influence_joints[v * influences])];
    if (body < 0) continue;
    const Transform& joint = model.skeleton.reference[at(bodies[at(body)].joint)];
    places[at(body)].push_back(joint.inverse() * Vec3(model.positions[v].cast<double>()));
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    std::vector<std::size_t> outermost;
    for (int i = 0; i < kDirections && !places[b].empty(); ++i) {
      const Vec3 towards = direction(i);
      const auto found = std::ranges::max_element(
          places[b], {}, [&](const Vec3& place) { return place.dot(towards); });
      outermost.push_back(static_cast<std::size_t>(found - places[b].begin()));
    }
    std::ranges::sort(outermost);
    outermost.erase(std::unique(outermost.begin(), outermost.end()), outermost.end());
    for (const std::size_t v : outermost) points.push_back({static_cast<int>(b), places[b][v], 0});
  }
}

}  // namespace

std::vector<SupportPoint> support_points(const std::vector<ragdoll::Body>& bodies,
                                         const Model* model) {
  std::vector<SupportPoint> points;
  if (model != nullptr) {
    add_vertices(bodies, *model, points);
    return points;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const bool box = bodies[b].shape.kind == ragdoll::Shape::Kind::box;
    (box ? add_box : add_capsule)(bodies[b], static_cast<int>(b), points);
  }
  return points;
}

std::optional<GroundPoint> surface_at(const Terrain& ground, const Vec3& place) {
  constexpr double kAbove = 0.5;  // metres
  const auto found = ground.at(place.x(), place.z(), place.y() + kAbove);
  return found ? found : ground.at(place.x(), place.z());
}

double clearance(const Terrain& ground, const Vec3& centre, double radius) {
  const auto height = [&](double x, double z, bool below_centre) {
    const auto found = surface_at(ground, {x, centre.y(), z});
    if (!found) return -std::numeric_limits<double>::infinity();
    return found->height + (below_centre ? radius / found->normal.y() : 0);
  };
  double highest = height(centre.x(), centre.z(), true);
  for (const double share : {0.7, 1.0}) {
    if (radius == 0) break;
    const double aside = share * radius, below = radius * std::sqrt(1 - share * share);
    for (const auto& [dx, dz] : {std::pair(aside, 0.0), std::pair(-aside, 0.0),
                                 std::pair(0.0, aside), std::pair(0.0, -aside)}) {
      highest = std::max(highest, height(centre.x() + dx, centre.z() + dz, false) + below);
    }
  }
  return centre.y() - highest;
}

// Where on the ground each point belongs: over the place that it has in the source, which does not
// change as the solution goes on, so that no part is drawn to and fro over an edge. Frames of the
// stretch before keep their targets.
void Settler::set_targets(int first, int last) {
  const auto clip = load(part_of(rooted_, first, last - first + 1), options_.jobs);
  if (!clip) {
    status_ = clip.error();
    return;
  }
  const std::size_t size = points_.size(), known = at(stretch_first_ + stretch_.frames - first);
  std::move(targets_.end() - static_cast<std::ptrdiff_t>(known * size), targets_.end(),
            targets_.begin());
  targets_.resize(known * size);
  stretch_first_ = first;
  stretch_ = local_motion(*clip);
  targets_.resize(at(stretch_.frames) * size);
  const auto count = at(frames());
  parallel_for(at(stretch_.frames) - known, 16, options_.jobs, [&](std::size_t from, auto to) {
    for (std::size_t i = known + from; i < known + to; ++i) {
      const std::vector<Transform> source = pose_of(stretch_, static_cast<int>(i));
      const int frame = first + static_cast<int>(i);
      for (std::size_t p = 0; p < size; ++p) {
        const SupportPoint& point = points_[p];
        const std::size_t b = at(point.body);
        Target& target = targets_[i * size + p];
        target.place = source[at(bodies_[b].joint)] * point.centre;
        const double height = over_rest(point, target.place, frame);
        const double before = follows_ground_ ? height : target.place.y() - point.radius - floor_;
        const double goal = std::max(0.0, before + raised_[b * count + at(frame)]);
        const double weight = 1 - smoother_step(goal / (kFar * scale_));
        if (!(weight > 1e-3) || !std::isfinite(height)) continue;
        target.weight = weight * weight;
        target.rise = goal - height;
        target.slope = slope_under(point, target.place, frame);
      }
    }
  });
}

}  // namespace krok::settling
