#include "render/actor.h"

#include <fmt/format.h>

namespace krok::render {

namespace {

constexpr float kMaxCoordinate = 1e15F;

bool usable(const Vec3f& point) {
  // NaN fails the comparison.
  return point.cwiseAbs().maxCoeff() <= kMaxCoordinate && point.allFinite();
}

bool usable(float radius) {
  return radius >= 0 && radius <= kMaxCoordinate;
}

Error fault(const char* what) {
  return Error("render-figure", fmt::format("cannot render the character: {}", what));
}

Status check(const Paint& paint, std::size_t vertices) {
  if (paint.image == nullptr || paint.image->levels().empty()) {
    return fault("a surface's texture has no image");
  }
  if (paint.coordinates == nullptr || paint.coordinates->size() != vertices) {
    return fault("number of texture coordinates does not match the vertices");
  }
  for (const Vec2f& place : *paint.coordinates) {
    if (!place.allFinite()) return fault("a texture coordinate is not finite");
  }
  if (!(paint.factor.minCoeff() >= 0 && paint.factor.maxCoeff() <= 1) ||
      !paint.factor.allFinite() || !(paint.cutoff >= 0 && paint.cutoff <= 1)) {
    return fault("the texture factor is not in 0 to 1");
  }
  return {};
}

Status check(const Surface& surface) {
  const std::size_t vertices = surface.positions.size();
  if (surface.triangles == nullptr) return fault("a surface has no triangles");
  if (!surface.normals.empty() && surface.normals.size() != vertices) {
    return fault("number of normals does not match the vertices");
  }
  if (surface.colours.size() != 1 && surface.colours.size() != vertices) {
    return fault("expected one colour or one per vertex");
  }
  for (const auto& triangle : *surface.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= vertices) return fault("a triangle index is out of range");
    }
  }
  for (const Vec3f& point : surface.positions) {
    if (!usable(point)) return fault("a vertex is not finite or is too far away");
  }
  for (const Vec3f& normal : surface.normals) {
    if (!normal.allFinite()) return fault("a normal is not finite");
  }
  if (surface.paint != nullptr) return check(*surface.paint, vertices);
  return {};
}

}  // namespace

Status check(const Actor& actor) {
  for (const Surface& surface : actor.surfaces) {
    if (Status status = check(surface); !status) return status;
  }
  for (const Bone& bone : actor.bones) {
    if (!usable(bone.from) || !usable(bone.to)) {
      return fault("a joint is not finite or is too far away");
    }
    if (!usable(bone.from_radius) || !usable(bone.to_radius)) {
      return fault("a bone's radius is negative or not finite");
    }
  }
  if (!usable(Vec3f(actor.centre.cast<float>()))) {
    return fault("its centre is not finite or is too far away");
  }
  return {};
}

Bounds bounds(const Actor& actor) {
  Eigen::AlignedBox3d box;
  for (const Surface& surface : actor.surfaces) {
    for (const Vec3f& point : surface.positions) box.extend(point.cast<double>());
  }
  const auto add_ball = [&box](const Vec3f& middle, float radius) {
    const Vec3 reach = Vec3::Constant(static_cast<double>(radius));
    box.extend(middle.cast<double>() - reach);
    box.extend(middle.cast<double>() + reach);
  };
  for (const Bone& bone : actor.bones) {
    add_ball(bone.from, bone.from_radius);
    add_ball(bone.to, bone.to_radius);
  }
  if (box.isEmpty()) box.extend(actor.centre);
  return {box.min(), box.max()};
}

}  // namespace krok::render
