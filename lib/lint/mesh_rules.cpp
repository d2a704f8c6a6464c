#include "lint/mesh_rules.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <compare>

#include "core/index.h"
#include "core/numbers.h"
#include "math/window.h"
#include "scene/mesh_volume.h"

namespace krok::lint {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr double kFlat = 1e-6;      // height of a degenerate triangle, of its longest side
constexpr double kTorn = 5;         // times longer
constexpr double kTornSize = 0.02;  // of the mesh's size
constexpr double kHidden = 0.01;    // of the largest scale: joints that hide what hangs on them
constexpr double kOpposite = -0.5;  // cosine of the angle to a triangle's normal

Finding finding_of(Rule rule, const MeshView& mesh, const Settings& settings) {
  Finding finding;
  finding.rule = rule;
  finding.mesh = mesh.name;
  finding.threshold = settings.threshold(rule);
  finding.unit = facts_of(rule).unit;
  return finding;
}

// Twice the area of a triangle as a vector along its normal, and its longest side.
std::pair<Vec3, double> cross_of(const MeshView& mesh, const Triangle& triangle) {
  const auto corner = [&](int k) { return mesh.positions[triangle[at(k)]].cast<double>(); };
  const Vec3 ab = corner(1) - corner(0), ac = corner(2) - corner(0);
  return {ab.cross(ac),
          std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}))};
}

// Adds a finding if `count` of `all` is more than the rule's limit, in percent.
void add_share(Finding finding, std::size_t count, std::size_t all, std::string detail,
               std::vector<Finding>& found) {
  if (count == 0) return;
  finding.value = 100.0 * static_cast<double>(count) / static_cast<double>(all);
  if (finding.value <= finding.threshold) return;
  finding.detail = std::move(detail);
  found.push_back(std::move(finding));
}

// Returns the triangles that are none of the degenerate ones.
std::vector<Triangle> find_degenerate(const MeshView& mesh, const Settings& settings,
                                      std::vector<Finding>& found) {
  std::vector<Triangle> sound;
  std::size_t repeated = 0, flat = 0, first = mesh.triangles.size();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const auto [cross, longest] = cross_of(mesh, mesh.triangles[t]);
    const bool twice = a == b || b == c || c == a;
    if (!twice && cross.norm() > kFlat * longest * longest) {
      sound.push_back(mesh.triangles[t]);
      continue;
    }
    ++(twice ? repeated : flat);
    first = std::min(first, t);
  }
  add_share(finding_of(Rule::degenerate_triangle, mesh, settings), repeated + flat,
            mesh.triangles.size(),
            fmt::format("{} with a vertex twice, {} without area, first triangle {}", repeated,
                        flat, first),
            found);
  return sound;
}

void find_winding(const MeshView& mesh, const Settings& settings,
                  std::span<const Triangle> triangles, std::vector<Finding>& found) {
  const std::vector<Vec3> positions = [&] {
    std::vector<Vec3> wide;
    for (const Vec3f& one : mesh.positions) wide.push_back(one.cast<double>());
    return wide;
  }();
  const auto place = first_at_position(positions);
  std::vector<Triangle> once;
  for (const Triangle& triangle : triangles) {
    Triangle& one = once.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) one[k] = place[triangle[k]];
    std::rotate(one.begin(), std::min_element(one.begin(), one.end()), one.end());
  }
  std::ranges::sort(once);
  once.erase(std::unique(once.begin(), once.end()), once.end());
  struct Edge {
    std::uint32_t low, high;
    bool upwards;
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  for (const Triangle& one : once) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = one[k], b = one[(k + 1) % 3];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::ranges::sort(edges);
  std::size_t shared = 0, against = 0, first = 0;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t next = i + 1;
    while (next < edges.size() && edges[next].low == edges[i].low &&
           edges[next].high == edges[i].high) {
      ++next;
    }
    if (next == i + 2) {
      ++shared;
      if (edges[i].upwards == edges[i + 1].upwards && against++ == 0) first = edges[i].low;
    }
    i = next;
  }
  add_share(finding_of(Rule::triangle_winding, mesh, settings), against, shared,
            fmt::format("{} of {} edges between triangles of opposite sides, first at vertex {}",
                        against, shared, first),
            found);
}

void find_normals(const MeshView& mesh, const Settings& settings,
                  std::span<const Triangle> triangles, std::vector<Finding>& found) {
  if (mesh.normals.empty()) return;
  constexpr double kUnseen = -2;
  std::vector<double> nearest(mesh.positions.size(), kUnseen);  // cosines, of the triangles around
  for (const Triangle& triangle : triangles) {
    const Vec3 face = cross_of(mesh, triangle).first.stableNormalized();
    for (const std::uint32_t v : triangle) {
      nearest[v] =
          std::max(nearest[v], mesh.normals[v].cast<double>().stableNormalized().dot(face));
    }
  }
  std::size_t zero = 0, opposite = 0, used = 0, first_zero = 0, first_opposite = 0;
  for (std::size_t v = 0; v < nearest.size(); ++v) {
    if (nearest[v] == kUnseen) continue;
    ++used;
    if (const float length = mesh.normals[v].norm(); !(length > 1e-3F)) {
      if (zero++ == 0) first_zero = v;
    } else if (nearest[v] < kOpposite && opposite++ == 0) {
      first_opposite = v;
    }
  }
  Finding finding = finding_of(Rule::vertex_normal, mesh, settings);
  finding.kind = "opposite";
  add_share(finding, opposite, used,
            fmt::format("{} against their triangles, first vertex {}", opposite, first_opposite),
            found);
  finding.kind = "zero", finding.threshold = 0;
  add_share(finding, zero, used, fmt::format("{}, first vertex {}", zero, first_zero), found);
}

void find_bind(const MeshView& mesh, const Settings& settings, std::vector<Finding>& found) {
  if (mesh.influences_per_vertex == 0 || mesh.inverse_binds.empty()) return;
  const std::size_t joints = mesh.inverse_binds.size();
  std::vector<double> scales(joints, 0), known;
  std::vector<char> used(joints, 0);
  for (std::size_t k = 0; k < mesh.influence_joints.size(); ++k) {
    if (mesh.influence_weights[k] > 0) used[mesh.influence_joints[k]] = 1;
  }
  std::vector<Mat4> palette(joints);
  std::size_t broken = 0, first_broken = 0;
  for (std::size_t j = 0; j < joints; ++j) {
    palette[j] = mesh.rests[j] * mesh.inverse_binds[j];
    if (used[j] == 0) continue;
    const Mat3 linear = mesh.inverse_binds[j].topLeftCorner<3, 3>();
    if (!(std::abs(linear.determinant()) > 1e-12 * std::pow(linear.norm(), 3))) {
      if (broken++ == 0) first_broken = j;
      continue;
    }
    scales[j] = std::cbrt(std::abs(palette[j].topLeftCorner<3, 3>().determinant()));
    known.push_back(scales[j]);
  }
  Finding finding = finding_of(Rule::bind_pose, mesh, settings);
  if (broken > 0) {
    Finding one = finding;
    one.kind = "singular", one.threshold = 0, one.value = static_cast<double>(broken);
    one.detail = fmt::format("{} cannot be inverted, first that of {}",
                             counted(broken, "inverse bind matrix", "inverse bind matrices"),
                             mesh.joint_names[first_broken]);
    found.push_back(std::move(one));
  }
  if (known.empty()) return;
  const double hidden = kHidden * std::ranges::max(known);
  std::erase_if(known, [&](double scale) { return scale <= hidden; });
  if (known.empty()) return;
  const double usual = median(known);
  std::size_t worst = joints;
  for (std::size_t j = 0; j < joints; ++j) {
    if (scales[j] <= hidden) continue;
    const double factor = std::max(scales[j] / usual, usual / scales[j]);
    if (factor <= std::max(finding.threshold, finding.value)) continue;
    finding.value = factor, worst = j;
  }
  if (worst < joints) {
    Finding one = finding;
    one.kind = "scale";
    one.detail = fmt::format("times the other joints' scale: {}", mesh.joint_names[worst]);
    found.push_back(std::move(one));
  }
  const auto each = at(mesh.influences_per_vertex);
  std::vector<Vec3> shown(mesh.positions.size(), Vec3::Zero());
  std::vector<char> whole(shown.size(), 1);
  Eigen::AlignedBox3d box;
  for (std::size_t v = 0; v < shown.size(); ++v) {
    const Vec3 position = mesh.positions[v].cast<double>();
    box.extend(position);
    for (std::size_t k = v * each; k < (v + 1) * each; ++k) {
      const std::size_t j = mesh.influence_joints[k];
      const auto weight = static_cast<double>(mesh.influence_weights[k]);
      if (!(weight > 0)) continue;
      if (scales[j] <= hidden) whole[v] = 0;
      shown[v] += weight * (palette[j] * position.homogeneous()).head<3>();
    }
  }
  const double long_enough = kTornSize * box.diagonal().norm();
  double most = 0;
  std::size_t torn = 0, edges = 0, place = 0;
  for (const Triangle& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      if (whole[a] == 0 || whole[b] == 0) continue;
      ++edges;
      const double before = (mesh.positions[a] - mesh.positions[b]).cast<double>().norm();
      const double after = (shown[a] - shown[b]).norm() / usual;
      if (after <= long_enough || after <= kTorn * before) continue;
      ++torn;
      if (after > most) most = after, place = a;
    }
  }
  if (torn == 0) return;
  finding.kind = "torn";
  finding.value = most / box.diagonal().norm() * 100, finding.threshold = 100 * kTornSize;
  finding.unit = "%";
  finding.detail = fmt::format(
      "of the mesh's size, the longest of {} of {} sides over {} times longer without "
      "animation, at vertex {}",
      torn, edges, kTorn, place);
  found.push_back(std::move(finding));
}

}  // namespace

std::vector<Finding> lint_mesh(const MeshView& mesh, const Settings& settings) {
  std::vector<Finding> found;
  const std::vector<Triangle> sound = find_degenerate(mesh, settings, found);
  if (settings.has(Rule::triangle_winding)) find_winding(mesh, settings, sound, found);
  find_normals(mesh, settings, sound, found);
  if (settings.has(Rule::bind_pose)) find_bind(mesh, settings, found);
  std::erase_if(found, [&](const Finding& finding) { return !settings.has(finding.rule); });
  return found;
}

}  // namespace krok::lint
