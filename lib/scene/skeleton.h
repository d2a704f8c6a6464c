#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "math/transform.h"

namespace krok {

// A tree of joints with a reference pose, in Krok's coordinate frame: metres, right-handed, +Y up,
// the character facing +Z (so its left is +X).
//
// A struct of arrays, all of length joint_count(). Parents come before their children; exactly one
// joint, the first, has no parent.
struct Skeleton {
  static constexpr int kNoParent = -1;

  std::vector<std::string> names;       // unique, not empty, UTF-8
  std::vector<int> parents;             // index of the parent, kNoParent for the root
  std::vector<std::uint8_t> end_sites;  // 1: a leaf that only marks the end of the last bone
  std::vector<Transform> reference;     // joint_to_world in the reference pose

  int joint_count() const { return static_cast<int>(names.size()); }
  bool empty() const { return names.empty(); }

  // Appends a joint; returns its index.
  int add(std::string name, int parent, const Transform& joint_to_world, bool end_site = false);

  // The index of a joint by its exact name, or -1.
  int find(std::string_view name) const;

  // joint_to_parent in the reference pose (joint_to_world for the root).
  Transform reference_local(int joint) const;

  // For each joint the indices of its children, in order.
  std::vector<std::vector<int>> children() const;
};

// Checks everything documented above: equal lengths, unique non-empty names, parents before
// children, one root, end sites without children, finite positions, unit orientations (within
// 1e-4). Codes: skeleton-shape, skeleton-name, skeleton-parent, skeleton-value.
Status check(const Skeleton& skeleton);

// joint_to_world of all joints from joint_to_parent of all joints. Both spans have [joints]
// elements; they may be the same.
void local_to_world(std::span<const int> parents, std::span<const Transform> joint_to_parent,
                    std::span<Transform> joint_to_world);

// The inverse of local_to_world. The spans must not overlap.
void world_to_local(std::span<const int> parents, std::span<const Transform> joint_to_world,
                    std::span<Transform> joint_to_parent);

// The largest extent (metres) of the reference pose along the three axes; 0 for one joint.
double reference_extent(const Skeleton& skeleton);

// The differences of two skeletons in names, order or parents, worded for a message; empty if there
// are none. Reference poses are not compared.
std::string difference_in_structure(const Skeleton& a, const Skeleton& b);

// Metres. No coordinate is farther from the origin: floats there are 64 m apart, and beyond 1e19
// their squares are infinite.
constexpr float kFarthest = 1e9F;

// Whether all coordinates are finite and within that.
template <typename Vector>
bool is_near(const Vector& position) {
  using Scalar = typename Vector::Scalar;
  return (position.array().abs() <= static_cast<Scalar>(kFarthest)).all();
}

}  // namespace krok
