#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/index.h"
#include "roles/joint_names.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

namespace krok {

// The hierarchy of a skeleton together with what its joint names state. The skeleton must outlive
// it.
class NamedJoints {
 public:
  // `names`: shape [joints].
  NamedJoints(const Skeleton& skeleton, std::vector<JointName> names);

  const Skeleton& skeleton() const { return skeleton_; }
  int count() const { return skeleton_.joint_count(); }
  int parent(int joint) const { return skeleton_.parents[at(joint)]; }
  const std::vector<int>& children(int joint) const { return children_[at(joint)]; }
  Part part(int joint) const { return names_[at(joint)].part; }
  Side side(int joint) const { return names_[at(joint)].side; }
  bool is_end(int joint) const { return skeleton_.end_sites[at(joint)] != 0; }
  bool is_helper(int joint) const { return part(joint) == Part::helper; }

  // Whether `joint` is `ancestor` or below it.
  bool descends(int joint, int ancestor) const;

  // The lowest common ancestor, which may be a or b. If one is -1, the other; -1 if both are.
  int common_ancestor(int a, int b) const;

  // Between two joints of the reference pose.
  double distance(int a, int b) const;

  // The child with the most descendants, other than helpers and end sites; -1 if there is none.
  int main_child(int joint) const;

  // The joint nearest to the root for which `wanted` holds, without end sites; the first of equals.
  template <typename Condition>
  int nearest(const Condition& wanted) const {
    int best = -1;
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      if (!is_end(j) && wanted(j) && (best < 0 || depths_[at(j)] < depths_[at(best)])) best = j;
    }
    return best;
  }

 private:
  const Skeleton& skeleton_;
  std::vector<JointName> names_;
  std::vector<std::vector<int>> children_;
  std::vector<int> depths_;                // [joints], 0 for the root
  std::vector<std::size_t> counts_below_;  // [joints], the joint included
};

// The joints at the ends of the limbs and the head; -1 for those that were not found.
struct LimbTips {
  std::array<int, 2> hands = {-1, -1};  // left, right
  std::array<int, 2> feet = {-1, -1};
  int head = -1;
  int neck = -1;
};

LimbTips find_limb_tips(const NamedJoints& joints);

// Part and side of each joint, shape [joints], derived from the reference pose alone, for skeletons
// without meaningful names. Requires a trunk between two mirrored pairs of limbs, an upright pose
// with the hands above the ground (unlike the front feet of quadrupeds), a branch for the head, and
// feet that show the facing direction, which determines left and right. Empty otherwise.
std::optional<std::vector<JointName>> names_from_shape(const Skeleton& skeleton);

// Roles from part and side of each joint (shape [joints]), checked against the hierarchy. `names`
// may come from another source than the skeleton's joint names.
RoleMap roles_from_names(const Skeleton& skeleton, std::vector<JointName> names);

}  // namespace krok
