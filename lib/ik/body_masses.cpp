#include <array>

#include "core/index.h"
#include "ik/anatomical_limits.h"

namespace krok::ik {

namespace {

constexpr double kBody = 73;  // kilograms

// Share of the body, and where the centre is on the way from the joint to the end of its part.
struct Part {
  Role role, end;
  double share, place;
};

constexpr std::array kParts = {
    Part{Role::left_upper_arm, Role::left_lower_arm, 0.0271, 0.5772},
    Part{Role::right_upper_arm, Role::right_lower_arm, 0.0271, 0.5772},
    Part{Role::left_lower_arm, Role::left_hand, 0.0162, 0.4574},
    Part{Role::right_lower_arm, Role::right_hand, 0.0162, 0.4574},
    Part{Role::left_upper_leg, Role::left_lower_leg, 0.1416, 0.4095},
    Part{Role::right_upper_leg, Role::right_lower_leg, 0.1416, 0.4095},
    Part{Role::left_lower_leg, Role::left_foot, 0.0433, 0.4395},
    Part{Role::right_lower_leg, Role::right_foot, 0.0433, 0.4395},
};

// Parts whose centre is put at the middle of what hangs on them.
struct Lump {
  Role role;
  double share;
};
constexpr std::array kLumps = {Lump{Role::left_hand, 0.0061}, Lump{Role::right_hand, 0.0061},
                               Lump{Role::left_foot, 0.0137}, Lump{Role::right_foot, 0.0137}};
constexpr double kHead = 0.0694, kPelvis = 0.1117, kTrunk = 0.3229;

Vec3 middle_of_children(const Skeleton& skeleton, int joint) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int j = joint + 1; j < skeleton.joint_count(); ++j) {
    if (skeleton.parents[at(j)] != joint) continue;
    sum += skeleton.reference_local(j).position;
    ++count;
  }
  return count == 0 ? Vec3(Vec3::Zero()) : Vec3(0.5 / count * sum);
}

}  // namespace

BodyMasses body_masses(const Skeleton& skeleton, const RoleMap& roles) {
  BodyMasses body;
  body.masses.assign(skeleton.names.size(), 0.0);
  body.centres.assign(skeleton.names.size(), Vec3::Zero());
  if (!roles.humanoid) return body;
  for (const Part& part : kParts) {
    const int joint = roles.joint(part.role), end = roles.joint(part.end);
    if (joint < 0 || end < 0) continue;
    body.masses[at(joint)] = kBody * part.share;
    const Transform& from = skeleton.reference[at(joint)];
    body.centres[at(joint)] =
        from.inverse() *
        Vec3(from.position + part.place * (skeleton.reference[at(end)].position - from.position));
  }
  const auto put = [&](int joint, double share) {
    if (joint < 0) return;
    body.masses[at(joint)] += kBody * share;
    body.centres[at(joint)] = middle_of_children(skeleton, joint);
  };
  for (const Lump& lump : kLumps) put(roles.joint(lump.role), lump.share);
  const int head = roles.joint(Role::head);
  put(head >= 0 ? head : roles.joint(Role::neck), kHead);
  put(roles.joint(Role::hips), kPelvis);
  std::vector<int> trunk = roles.joints(Role::spine);
  for (const int joint : roles.joints(Role::chest)) trunk.push_back(joint);
  if (trunk.empty()) {
    put(roles.joint(Role::hips), kTrunk);
  } else {
    for (const int joint : trunk) put(joint, kTrunk / static_cast<double>(trunk.size()));
  }
  return body;
}

}  // namespace krok::ik
