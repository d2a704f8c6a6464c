#include "scene/skeleton.h"

#include <fmt/format.h>

#include <cmath>
#include <unordered_set>

#include "core/text.h"

namespace krok {

int Skeleton::add(std::string name, int parent, const Transform& joint_to_world, bool end_site) {
  names.push_back(std::move(name));
  parents.push_back(parent);
  end_sites.push_back(end_site ? 1 : 0);
  reference.push_back(joint_to_world);
  return joint_count() - 1;
}

int Skeleton::find(std::string_view name) const {
  for (int i = 0; i < joint_count(); ++i) {
    if (names[static_cast<std::size_t>(i)] == name) return i;
  }
  return -1;
}

Transform Skeleton::reference_local(int joint) const {
  const auto j = static_cast<std::size_t>(joint);
  const int parent = parents[j];
  if (parent < 0) return reference[j];
  return reference[static_cast<std::size_t>(parent)].inverse() * reference[j];
}

std::vector<std::vector<int>> Skeleton::children() const {
  std::vector<std::vector<int>> lists(names.size());
  for (int i = 0; i < joint_count(); ++i) {
    const int parent = parents[static_cast<std::size_t>(i)];
    if (parent >= 0) lists[static_cast<std::size_t>(parent)].push_back(i);
  }
  return lists;
}

Status check(const Skeleton& skeleton) {
  const std::size_t count = skeleton.names.size();
  if (skeleton.parents.size() != count || skeleton.end_sites.size() != count ||
      skeleton.reference.size() != count) {
    return Error("skeleton-shape", "names, parents and reference pose have different lengths");
  }
  if (count == 0) return Error("skeleton-shape", "the skeleton has no joints");
  std::unordered_set<std::string_view> seen;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string& name = skeleton.names[i];
    if (name.empty()) return Error("skeleton-name", fmt::format("joint {} has no name", i));
    if (!is_utf8(name)) {
      return Error("skeleton-name", fmt::format("the name of joint {} is not UTF-8", i));
    }
    if (!seen.insert(name).second) {
      return Error("skeleton-name", fmt::format("two joints are named {}", name));
    }
    const int parent = skeleton.parents[i];
    if (i == 0 ? parent != Skeleton::kNoParent : (parent < 0 || parent >= static_cast<int>(i))) {
      return Error("skeleton-parent",
                   fmt::format("joint {} ({}) has parent {}, expected {}", i, name, parent,
                               i == 0 ? "none" : "an earlier joint"));
    }
    if (parent >= 0 && skeleton.end_sites[static_cast<std::size_t>(parent)] != 0) {
      return Error(
          "skeleton-parent",
          fmt::format("the parent of joint {} is {}, an end site, which must not have children",
                      name, skeleton.names[static_cast<std::size_t>(parent)]));
    }
    const Transform& transform = skeleton.reference[i];
    if (!is_near(transform.position) || !transform.orientation.coeffs().allFinite() ||
        std::abs(transform.orientation.norm() - 1.0) > 1e-4) {
      return Error(
          "skeleton-value",
          fmt::format(
              "the reference pose of joint {} is not finite, over 1e9 m away or not a rotation",
              name));
    }
  }
  return {};
}

void local_to_world(std::span<const int> parents, std::span<const Transform> joint_to_parent,
                    std::span<Transform> joint_to_world) {
  for (std::size_t i = 0; i < parents.size(); ++i) {
    const int parent = parents[i];
    joint_to_world[i] = parent < 0
                            ? joint_to_parent[i]
                            : joint_to_world[static_cast<std::size_t>(parent)] * joint_to_parent[i];
  }
}

void world_to_local(std::span<const int> parents, std::span<const Transform> joint_to_world,
                    std::span<Transform> joint_to_parent) {
  for (std::size_t i = 0; i < parents.size(); ++i) {
    const int parent = parents[i];
    joint_to_parent[i] =
        parent < 0 ? joint_to_world[i]
                   : joint_to_world[static_cast<std::size_t>(parent)].inverse() * joint_to_world[i];
  }
}

double reference_extent(const Skeleton& skeleton) {
  if (skeleton.empty()) return 0;
  Eigen::AlignedBox3d box;
  for (const Transform& transform : skeleton.reference) box.extend(transform.position);
  return box.sizes().maxCoeff();
}

std::string difference_in_structure(const Skeleton& a, const Skeleton& b) {
  const int common = std::min(a.joint_count(), b.joint_count());
  for (int i = 0; i < common; ++i) {
    const auto j = static_cast<std::size_t>(i);
    if (a.names[j] != b.names[j]) {
      return fmt::format("joint {} is {} in the first and {} in the second", i, a.names[j],
                         b.names[j]);
    }
    if (a.parents[j] != b.parents[j]) {
      const auto name_of = [](const Skeleton& s, int parent) {
        return parent < 0 ? std::string("none") : s.names[static_cast<std::size_t>(parent)];
      };
      return fmt::format("the parent of {} is {} in the first and {} in the second", a.names[j],
                         name_of(a, a.parents[j]), name_of(b, b.parents[j]));
    }
  }
  if (a.joint_count() != b.joint_count()) {
    const Skeleton& longer = a.joint_count() > b.joint_count() ? a : b;
    return fmt::format("{} joints in the first, {} in the second (first extra joint: {})",
                       a.joint_count(), b.joint_count(),
                       longer.names[static_cast<std::size_t>(common)]);
  }
  return {};
}

}  // namespace krok
