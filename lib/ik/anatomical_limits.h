#pragma once

#include <vector>

#include "ik/limits.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

namespace krok::ik {

// Ranges of motion of healthy adults by the joints' roles: American Academy of Orthopaedic
// Surgeons, "Joint Motion: Method of Measuring and Recording" (1965), as given in Norkin and White,
// "Measurement of Joint Motion"; the collar bone's after Inman, Saunders and Abbott (1944), the
// knee's own rotation after Kapandji.
//
// Angles are measured from the anatomical position, which is built from the directions of the bones
// in the reference pose (arms may be held anywhere but straight up), so that how a skeleton orients
// its joints and which way it lies do not matter. Feet, hands, spine, neck and head count as
// neutral in the reference pose. The spine's range is shared by its joints. The turning of the
// forearm and its bend may both be in the elbow's joint, or the turning in the wrist's, as captures
// have either.
//
// Joints whose role is not known, and helpers, are free; end sites are locked; all are free where
// the roles are not those of a humanoid.
Limits anatomical_limits(const Skeleton& skeleton, const RoleMap& roles);

// What a body's joints carry, by role, for balance: masses (kilograms, for a body of 73 kg) and
// their centres in the joints' frames. De Leva, "Adjustments to Zatsiorsky-Seluyanov's segment
// inertia parameters" (1996), men's. All zero where the roles are not those of a humanoid.
struct BodyMasses {
  std::vector<double> masses;  // [joints]
  std::vector<Vec3> centres;
};
BodyMasses body_masses(const Skeleton& skeleton, const RoleMap& roles);

}  // namespace krok::ik
