#include "ragdoll/joint.h"

#include <algorithm>

namespace krok::ragdoll {

std::string_view joint_kind_name(JointKind kind) {
  switch (kind) {
    case JointKind::fixed:
      return "fixed";
    case JointKind::distance:
      return "distance";
    case JointKind::spherical:
      return "spherical";
    case JointKind::revolute:
      return "revolute";
    case JointKind::prismatic:
      return "prismatic";
    case JointKind::six_dof:
      return "six_dof";
  }
  return "";
}

bool can_slide(const Joint& joint) {
  return joint.kind == JointKind::prismatic || joint.kind == JointKind::distance ||
         (joint.kind == JointKind::six_dof &&
          std::ranges::any_of(joint.slide, [](const Range& r) { return r.min != r.max; }));
}

}  // namespace krok::ragdoll
