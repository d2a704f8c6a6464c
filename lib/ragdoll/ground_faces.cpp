#include "ragdoll/ground_faces_internal.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace krok::ragdoll {

namespace {

constexpr double kWall = 1e-3;  // of a face's normal, upwards

Vec3 corner_of(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace

void Faces::processTriangle(btVector3* corners, int /*part*/, int number) {
  numbers_.push_back(number);
  Face face;
  for (std::size_t k = 0; k < 3; ++k) face.corners[k] = corner_of(corners[k]);
  const auto& [a, b, c] = face.corners;
  face.normal = (b - a).cross(c - a);
  const double size = face.normal.norm();
  if (!(size > 1e-12)) return;
  face.normal /= size;
  face.inward = {face.normal.cross(b - a), face.normal.cross(c - b), face.normal.cross(a - c)};
  face.wall = std::abs(face.normal.y()) < kWall;
  if (face.normal.y() < 0) face.normal = -face.normal;  // ground is solid below
  if (const Vec3& out = edges_.wall_side(number); face.wall && !out.isZero()) {
    face.normal = out;
    face.wall = false;
  }
  faces_.push_back(face);
}

void find_touches(const Vec3& point, double radius, const Vec3& free, double reach,
                  std::span<const Faces::Face> faces, std::vector<Touch>& touches) {
  touches.clear();
  for (const Faces::Face& face : faces) {
    const double side = face.wall && face.normal.dot(free - face.corners[0]) < 0 ? -1 : 1;
    const Vec3 normal = side * face.normal;
    const Vec3 on_body = point - radius * normal;
    const double gap = normal.dot(on_body - face.corners[0]);
    if (gap < -kThick || gap > reach || !face.is_beside(on_body)) continue;
    touches.push_back({gap, normal, on_body});
  }
  std::ranges::stable_sort(touches, std::greater(), &Touch::gap);
  std::size_t kept = 0;
  Vec3 out = Vec3::Zero();
  for (const Touch& candidate : touches) {
    if (kept == kTouches) break;
    const Vec3 on_face = candidate.on_body - candidate.gap * candidate.normal;
    const auto behind = [&](const Faces::Face& face) {  // and not another step's wall
      return std::abs(face.normal.dot(candidate.normal)) > kSameWay &&
             std::abs(face.normal.dot(face.corners[0] - on_face)) < kThick &&
             face.is_beside(candidate.on_body + out);
    };
    if (kept > 0 && (touches[0].normal.dot(candidate.normal) > kSameWay ||
                     !std::ranges::any_of(faces, behind))) {
      continue;
    }
    touches[kept++] = candidate;
    if (candidate.gap < 0) out -= 1.01 * candidate.gap * candidate.normal;
  }
  touches.resize(kept);
}

}  // namespace krok::ragdoll
