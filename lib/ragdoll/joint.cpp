#include "ragdoll/joint.h"

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

}  // namespace krok::ragdoll
