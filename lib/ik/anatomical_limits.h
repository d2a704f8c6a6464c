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

// Stiffness of joints, [joints], 0 to 1 (Options::stiffness), so that arms reach first, and collar
// bones, spine and chest only as far as arms do not: the trunk's joints turn by the square of an
// arm's mass over the mass that they carry, all of them together as one; collar bones count as a
// quarter of the trunk. `whole_body`, 0 to 1, is how much the trunk takes part: 1 as any other
// joint, 0.5 by the square, 0 by the fourth power. 0 for all where the roles are not those of a
// humanoid.
std::vector<double> trunk_stiffness(const Skeleton& skeleton, const RoleMap& roles,
                                    double whole_body);

}  // namespace krok::ik
