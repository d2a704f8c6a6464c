#include "skin/bind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "core/index.h"
#include "scene/mesh_volume.h"

namespace krok {

namespace {

constexpr double kInside = 0.25;      // of the winding number
constexpr double kShortBone = 0.02;   // of the extent
constexpr double kSuspicious = 0.05;  // of the length of all bones
constexpr double kMost = 0.75;

struct Surface {
  std::vector<Vec3> positions;
  const std::vector<std::array<std::uint32_t, 3>>& triangles;

  double winding_number(const Vec3& at) const {
    double sum = 0;
    for (const auto& triangle : triangles) {
      const Vec3 a = positions[triangle[0]] - at, b = positions[triangle[1]] - at,
                 c = positions[triangle[2]] - at;
      const Vec3 middle = (a + b + c) / 3, area = 0.5 * (b - a).cross(c - a);
      const double squared = middle.squaredNorm();
      if (squared > 16 * area.norm()) {  // far enough to be a dipole
        sum += area.dot(middle) / (squared * std::sqrt(squared));
        continue;
      }
      // Solid angle: Van Oosterom, Strackee 1983.
      const double x = a.norm(), y = b.norm(), z = c.norm();
      sum +=
          2 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
    }
    return sum / (4 * kPi);
  }

  bool is_outside(const Vec3& from, const Vec3& to) const {
    return std::ranges::all_of(std::initializer_list<double>{0.5, 0.25, 0.75}, [&](double share) {
      return std::abs(winding_number(from + share * (to - from))) < kInside;
    });
  }
};

}  // namespace

Diagnostics reference_pose_faults(const Model& model) {
  const Skeleton& skeleton = model.skeleton;
  std::vector<double> moved(skeleton.names.size());  // weights of each joint
  for (std::size_t k = 0; k < model.influence_weights.size(); ++k) {
    moved[model.influence_joints[k]] += static_cast<double>(model.influence_weights[k]);
  }
  Surface surface{{}, model.triangles};
  for (const Vec3f& position : model.positions)
    surface.positions.push_back(position.cast<double>());
  const double shortest = kShortBone * reference_extent(skeleton);
  double all = 0, outside = 0, longest = 0;
  int worst = -1, count = 0;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.parents[at(j)];
    if (parent < 0 || moved[at(parent)] < 1) continue;
    const Vec3 from = skeleton.reference[at(parent)].position;
    const Vec3 to = skeleton.reference[at(j)].position;
    const double length = (to - from).norm();
    if (!(length > shortest)) continue;
    all += length;
    if (!surface.is_outside(from, to)) continue;
    outside += length;
    ++count;
    if (length > longest) {
      longest = length;
      worst = j;
    }
  }
  if (!(outside > kSuspicious * all)) return {};
  if (outside > kMost * all && !mesh_volume(surface.positions, model.triangles).closed) return {};
  Diagnostic fault = make_warning(
      "skin-reference-pose",
      fmt::format(
          "{} of the reference pose {} outside of the mesh, such as that from {} to {}: the "
          "skeleton is not in the pose of the mesh, which skinning distorts",
          count == 1 ? "a bone" : fmt::format("{} bones", count), count == 1 ? "lies" : "lie",
          skeleton.names[at(skeleton.parents[at(worst)])], skeleton.names[at(worst)]),
      "export the character in its bind pose, in which the mesh was attached to its joints");
  fault.joint = skeleton.names[at(worst)];
  return {fault};
}

}  // namespace krok
