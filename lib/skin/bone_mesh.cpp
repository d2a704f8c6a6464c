#include "skin/bind.h"

#include <algorithm>
#include <array>

#include "math/quaternion.h"

namespace krok {

namespace {

constexpr double kThickness = 0.08;     // half-width of a bone, relative to its length
constexpr double kMaxThickness = 0.03;  // relative to the skeleton's extent
constexpr double kWaist = 0.2;          // position of the thickest point along a bone
constexpr double kSmallest = 1e-3;      // shortest bone shown, relative to the skeleton's extent
constexpr double kLoneSize = 0.1;       // metres

// Appends an octahedron from `base` to `tip`: eight triangles without shared vertices.
void add_bone(Model& model, int joint, const Vec3& base, const Vec3& tip, double half_width) {
  const Quat turn = shortest_arc(Vec3::UnitY(), tip - base);
  const Vec3 waist = base + kWaist * (tip - base);
  std::array<Vec3, 4> ring;
  for (int i = 0; i < 4; ++i) {
    const Vec3 corner(i % 2 == 0 ? 1 - i : 0, 0, i % 2 == 1 ? 2 - i : 0);
    ring[i] = waist + turn * (half_width * corner);
  }
  const auto add_triangle = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3f normal = (b - a).cross(c - a).normalized().cast<float>();
    const auto first = static_cast<std::uint32_t>(model.positions.size());
    for (const Vec3& corner : {a, b, c}) {
      model.positions.push_back(corner.cast<float>());
      model.normals.push_back(normal);
      model.influence_joints.push_back(static_cast<std::uint16_t>(joint));
      model.influence_weights.push_back(1.0f);
    }
    model.triangles.push_back({first, first + 1, first + 2});
  };
  // The ring goes +x, +z, -x, -z: clockwise seen from the tip.
  for (int i = 0; i < 4; ++i) {
    const Vec3 &a = ring[i], &b = ring[(i + 1) % 4];
    add_triangle(tip, b, a);
    add_triangle(base, a, b);
  }
}

}  // namespace

Model bone_mesh(const Skeleton& skeleton) {
  Model model;
  model.skeleton = skeleton;
  model.influences_per_vertex = 1;
  const double size = reference_extent(skeleton);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.parents[j];
    if (parent == Skeleton::kNoParent) continue;
    const Vec3& base = skeleton.reference[parent].position;
    const Vec3& tip = skeleton.reference[j].position;
    const double length = (tip - base).norm();
    if (!(length > kSmallest * size)) continue;
    add_bone(model, parent, base, tip, std::min(kThickness * length, kMaxThickness * size));
  }
  if (model.positions.empty()) {
    const Vec3& place = skeleton.reference[0].position;
    add_bone(model, 0, place, place + Vec3(0, kLoneSize, 0), kThickness * kLoneSize);
  }
  model.parts.push_back({"bones", "bones", 0, static_cast<std::uint32_t>(model.triangles.size())});
  return model;
}

}  // namespace krok
