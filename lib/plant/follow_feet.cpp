#include "plant/follow_feet.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "contacts/contacts.h"
#include "contacts/legs.h"
#include "math/quaternion.h"
#include "math/window.h"
#include "motion/hips_root.h"
#include "plant/foot_paths_internal.h"
#include "plant/sole_follower_internal.h"

namespace krok {

namespace {

using plant::FootPath;
using plant::SoleFollower;

constexpr double kGroundSmoothing = 0.25;  // seconds, of the height between the feet

// Moves the body so that the hips are over the source's, at `scale` of their height.
void move_body(const Clip& source, int carrier, double scale, const std::vector<double>& between,
               Clip& clip) {
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Vec3 hips = source.frame_positions(f)[static_cast<std::size_t>(carrier)].cast<double>();
    const Vec3 shift = (1 - scale) * Vec3(hips.x(), between[static_cast<std::size_t>(f)], hips.z());
    for (Vec3f& at : clip.frame_positions(f)) at = (at.cast<double>() + shift).cast<float>();
  }
}

// From hip joint to hip joint, metres.
double hip_width(const Skeleton& skeleton, const RoleMap& roles) {
  const auto hip = [&](FootSide side) {
    const auto joint = static_cast<std::size_t>(leg_joints(roles, side).upper);
    return skeleton.reference[joint].position;
  };
  return (hip(FootSide::left) - hip(FootSide::right)).norm();
}

// Height of the ground between the feet: the mean over both feet, interpolated between stances.
std::vector<double> ground_between(const std::vector<SoleFollower>& feet, const Clip& source) {
  std::vector<double> heights(static_cast<std::size_t>(source.frame_count()), 0);
  for (const SoleFollower& foot : feet) {
    for (int f = 0; f < source.frame_count(); ++f) {
      heights[static_cast<std::size_t>(f)] +=
          foot.standing_height(f) / static_cast<double>(feet.size());
    }
  }
  // Three times: nearly a bell curve.
  const auto reach = static_cast<int>(std::lround(kGroundSmoothing * source.rate));
  for (int round = 0; round < 3; ++round) heights = mean_within(heights, reach);
  return heights;
}

}  // namespace

Result<FollowedFeet> follow_feet(const Clip& source, const RoleMap& source_roles, const Clip& clip,
                                 const RoleMap& roles, double scale, const GroundBelow& ground,
                                 std::optional<std::span<const Contact>> contacts) {
  if (source.frame_count() != clip.frame_count() || source.rate != clip.rate) {
    return Error("follow-frames", "a motion and its retargeted copy differ in frames");
  }
  FoundContacts found;
  if (!contacts) {
    auto detected = find_contacts(source, source_roles);
    if (!detected) return detected.error();
    found = *std::move(detected);
    contacts = found.contacts;
  }
  std::vector<SoleFollower> feet;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    auto foot = SoleFollower::create(source, source_roles, side, ground, *contacts);
    if (!foot) return foot.error();
    feet.push_back(*std::move(foot));
  }
  FollowedFeet followed;
  followed.clip = clip;
  move_body(source, carrying_joint(source_roles), scale, ground_between(feet, source),
            followed.clip);
  auto body = plant::find_body(followed.clip, roles);
  if (!body) return body.error();
  if (body->legs.size() != feet.size()) {
    return Error("contacts-feet", "a leg of the target is not known from the hip to the foot",
                 "a role map tells which joints are legs and feet");
  }
  // Soles that face as the ground does, which need not be level.
  const Feet soles = find_feet(followed.clip, roles, ground.up);
  const double beside = beside_for_hips(hip_width(clip.skeleton, roles),
                                        hip_width(source.skeleton, source_roles), body->leg_length);
  std::vector<FootPath> paths;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    body->legs[i].points = soles.points[i];
    Status status = feet[i].lead_foot(followed.clip, body->legs[i], beside, ground);
    if (!status) return status.error();
    paths.push_back(feet[i].path(followed.clip));
  }
  const std::vector<double> lowered = lowering(followed.clip, *body, paths);
  if (!lowered.empty()) followed.pelvis_lowered = std::ranges::max(lowered);
  followed.out_of_reach = apply(*body, paths, lowered, followed.clip);
  for (const SoleFollower& foot : feet) foot.add_contacts(followed.clip, followed.contacts);
  std::ranges::sort(followed.contacts, [](const Contact& a, const Contact& b) {
    return std::pair(a.start, a.joint) < std::pair(b.start, b.joint);
  });
  for (const SoleFollower& foot : feet) foot.measure(followed.clip, ground, followed);
  return followed;
}

}  // namespace krok
