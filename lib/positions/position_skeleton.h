#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "roles/roles.h"
#include "scene/skeleton.h"

// What the columns of an array of joints are: published orders, and skeletons made of them.

namespace krok {

struct PositionJoint {
  std::string name;
  std::string parent;                // empty for the root
  std::vector<std::string> mean_of;  // columns; empty: the joint is a column itself
  std::string role;                  // as role_label(); empty: by the name
};

struct PositionSkeleton {
  // Columns in the order of the array, then joints that are the mean of several.
  std::vector<PositionJoint> joints;
  double rate = 0;  // usual frames per second; 0: unknown

  int columns() const;
};

// smpl22, smpl24, smplh52, smplx55, humanml22, kit21, h36m17, coco17, mediapipe33, optitrack21
// (also as optitrack), soma30, soma77, g1_34. Empty for other names.
std::optional<PositionSkeleton> named_skeleton(std::string_view name);
std::vector<std::string> skeleton_names();

// The names of skeletons with so many columns.
std::vector<std::string_view> skeletons_of_columns(std::size_t columns);

// A skeleton in Krok's frame with parents first.
struct ArrangedSkeleton {
  // The reference pose is a T-pose of 1.72 m, with the proportions of Drillis and Contini (1966),
  // where roles are known; other joints are at their parents.
  Skeleton skeleton;
  RoleMap roles;
  std::vector<std::vector<int>> columns;  // [joints] of which a joint's place is the mean
};

// Codes: skeleton-parent (a parent that is not there, a loop, several roots), skeleton-name (a name
// that is empty or twice), those of find_roles().
Result<ArrangedSkeleton> arrange(const PositionSkeleton& joints);

}  // namespace krok
