#include "capture/conventions.h"
#include "capture/figure_internal.h"

namespace krok {

Conventions detect_conventions(const Skeleton& skeleton, const RoleMap& roles,
                               std::span<const Vec3> sample_positions) {
  const figure::Evidence evidence(skeleton, roles, sample_positions);
  Conventions found;
  figure::detect_up(evidence, found);
  figure::detect_forward(evidence, found);
  figure::detect_reference_axes(evidence, found);
  figure::detect_unit(evidence, found);
  return found;
}

}  // namespace krok
