#include <algorithm>
#include <cmath>

#include "character/mesh_vertices_internal.h"

namespace krok::character {

void make_missing_normals(Model& model) {
  std::vector<Vec3> sums(model.positions.size(), Vec3::Zero());
  for (const auto& corners : model.triangles) {
    const auto corner = [&](int k) -> Vec3 { return model.positions[corners[k]].cast<double>(); };
    const Vec3 area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (const std::uint32_t one : corners) sums[one] += area;
  }
  for (std::size_t v = 0; v < sums.size(); ++v) {
    Vec3f& normal = model.normals[v];
    if (normal.squaredNorm() > 0.5f) continue;
    const double length = sums[v].stableNorm();
    normal = length > 0 && std::isfinite(length) ? Vec3f((sums[v] / length).cast<float>())
                                                 : Vec3f(Vec3f::UnitY());
  }
}

bool same_vertices(const nodes::Primitive& a, const nodes::Primitive& b) {
  const auto same_target = [](const nodes::MorphTarget& first, const nodes::MorphTarget& second) {
    return first.positions == second.positions && first.normals == second.normals;
  };
  return a.positions == b.positions && a.normals == b.normals && a.tangents == b.tangents &&
         a.texture_coordinates == b.texture_coordinates &&
         a.more_texture_coordinates == b.more_texture_coordinates && a.colours == b.colours &&
         a.influences_per_vertex == b.influences_per_vertex &&
         std::ranges::equal(a.targets, b.targets, same_target) &&
         a.influence_joints == b.influence_joints && a.influence_weights == b.influence_weights;
}

}  // namespace krok::character
