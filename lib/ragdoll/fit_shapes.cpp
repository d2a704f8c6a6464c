#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ragdoll/fit_shapes_internal.h"

namespace krok::ragdoll {

namespace {

constexpr double kInside = 0.9;  // share of the vertices that a shape reaches
constexpr std::size_t kFewest = 12;

double quantile(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

void fit_box(const std::vector<Vec3>& points, Body& body) {
  Vec3 centre = Vec3::Zero(), half = body.shape.half;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vec3& point : points) values.push_back(point[axis]);
    // Each of six sides cuts off its part.
    const double low = quantile(values, (1 - kInside) / 6);
    const double high = quantile(values, 1 - (1 - kInside) / 6);
    if (high - low < 0.01) continue;
    centre[axis] = 0.5 * (low + high);
    half[axis] = 0.5 * (high - low);
  }
  body.shape.half = half;
  body.to_joint.position = body.to_joint * centre;
}

void fit_capsule(const std::vector<Vec3>& points, Body& body) {
  Shape& shape = body.shape;
  const double whole = shape.half_length + shape.radius;
  std::vector<double> distances;
  for (const Vec3& point : points) distances.push_back(std::hypot(point.x(), point.z()));
  shape.radius = std::clamp(quantile(distances, kInside), 0.05 * whole, 0.95 * whole);
  shape.half_length = whole - shape.radius;
}

// 0 inside.
double distance_to(const Shape& shape, Vec3 point) {
  switch (shape.kind) {
    case Shape::Kind::box:
      return (point.cwiseAbs() - shape.half).cwiseMax(0).norm();
    case Shape::Kind::capsule:
      point.y() -= std::clamp(point.y(), -shape.half_length, shape.half_length);
      break;
    case Shape::Kind::sphere:
      break;
  }
  return std::max(0.0, point.norm() - shape.radius);
}

}  // namespace

double covered_share(const Model& model, const std::vector<Body>& bodies, double distance) {
  if (model.positions.empty()) return 1;
  std::vector<Transform> to_body;
  for (const Body& body : bodies) {
    to_body.push_back((model.skeleton.reference[at(body.joint)] * body.to_joint).inverse());
  }
  std::size_t covered = 0;
  for (const Vec3f& position : model.positions) {
    const Vec3 point = position.cast<double>();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (distance_to(bodies[b].shape, to_body[b] * point) > distance) continue;
      ++covered;
      break;
    }
  }
  return static_cast<double>(covered) / static_cast<double>(model.positions.size());
}

void fit_shapes(const Model& model, std::vector<Body>& bodies) {
  const std::vector<int> carrier = body_of_joint(model.skeleton, bodies);
  std::vector<std::vector<Vec3>> points(bodies.size());
  const auto influences = static_cast<std::size_t>(model.influences_per_vertex);
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    const int joint = model.influence_joints[v * influences];  // the largest weight comes first
    const int body = carrier[at(joint)];
    if (body < 0) continue;
    const Body& its = bodies[at(body)];
    const Transform to_world = model.skeleton.reference[at(its.joint)] * its.to_joint;
    points[at(body)].push_back(to_world.inverse() * Vec3(model.positions[v].cast<double>()));
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (points[b].size() < kFewest) continue;
    if (bodies[b].shape.kind == Shape::Kind::box) {
      fit_box(points[b], bodies[b]);
    } else {
      fit_capsule(points[b], bodies[b]);
    }
  }
}

}  // namespace krok::ragdoll
