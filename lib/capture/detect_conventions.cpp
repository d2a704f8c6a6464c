#include "capture/actor_internal.h"
#include "capture/conventions.h"

namespace krok {

Conventions detect_conventions(const Skeleton& skeleton, const RoleMap& roles,
                               std::span<const Vec3> sample_positions) {
  const actor::Evidence evidence(skeleton, roles, sample_positions);
  Conventions found;
  actor::detect_up(evidence, found);
  actor::detect_forward(evidence, found);
  actor::detect_reference_axes(evidence, found);
  actor::detect_unit(evidence, found);
  return found;
}

}  // namespace krok
