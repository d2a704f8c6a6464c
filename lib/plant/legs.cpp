#include <algorithm>

#include "motion/hips_root.h"
#include "plant/legs_internal.h"

namespace krok::plant {

namespace {

// The hips, or what is above them and all legs.
int pelvis_of(const Skeleton& skeleton, const RoleMap& roles, const std::vector<Leg>& legs) {
  int pelvis = carrying_joint(roles);
  const auto carries = [&](int joint) {
    return std::ranges::all_of(
        legs, [&](const Leg& leg) { return is_below(skeleton, leg.upper, joint); });
  };
  while (!carries(pelvis)) pelvis = skeleton.parents[static_cast<std::size_t>(pelvis)];
  return pelvis;
}

// The hinge axis of the knee from the motion; the line across the hips if the knee never bends.
Vec3 knee_axis_of(const Clip& clip, const Leg& leg, const std::vector<Leg>& legs) {
  constexpr double kBends = 0.02;  // the mean sine
  Vec3 bend = Vec3::Zero(), across = Vec3::Zero();
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Transform upper = joint_at(clip, f, leg.upper);
    const Vec3 knee = joint_at(clip, f, leg.lower).position;
    const Vec3 ankle = joint_at(clip, f, leg.foot).position;
    const Vec3 thigh = (knee - upper.position).stableNormalized();
    const Vec3 shank = (ankle - knee).stableNormalized();
    bend += upper.orientation.conjugate() * thigh.cross(shank);
    if (legs.size() == 2) {
      across += upper.orientation.conjugate() * (joint_at(clip, f, legs[0].upper).position -
                                                 joint_at(clip, f, legs[1].upper).position);
    }
  }
  const bool bends = bend.norm() > kBends * clip.frame_count();
  return (bends ? bend : across).stableNormalized();
}

}  // namespace

Result<PlantedBody> find_body(const Clip& clip, const RoleMap& roles) {
  const Skeleton& skeleton = clip.skeleton;
  const Feet feet = find_feet(clip, roles);
  PlantedBody body;
  body.leg_length = feet.leg_length;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    Leg leg{leg_joints(roles, side), side};
    leg.toes = -1;
    leg.points = feet.points[static_cast<std::size_t>(side)];
    if (leg.upper < 0 || leg.lower < 0 || leg.points.empty()) continue;
    leg.foot = leg.points.front().joint;  // of the heel
    if (!is_below(skeleton, leg.lower, leg.upper) || !is_below(skeleton, leg.foot, leg.lower)) {
      continue;
    }
    const SolePoint* ball = leg.point(FootPart::ball);
    if (ball && ball->joint != leg.foot) leg.toes = ball->joint;
    body.legs.push_back(std::move(leg));
  }
  if (body.legs.empty()) {
    return Error("contacts-feet", "no leg of this skeleton is known from the hip to the foot",
                 "a role map tells which joints are legs and feet");
  }
  for (Leg& leg : body.legs) leg.knee_axis = knee_axis_of(clip, leg, body.legs);
  body.pelvis = pelvis_of(skeleton, roles, body.legs);
  body.bodies.assign(skeleton.names.size(), Body::none);
  body.side.assign(skeleton.names.size(), 0);
  for (std::size_t j = 0; j < body.bodies.size(); ++j) {
    const int parent = skeleton.parents[j];
    if (parent >= 0) {
      body.bodies[j] = body.bodies[static_cast<std::size_t>(parent)];
      body.side[j] = body.side[static_cast<std::size_t>(parent)];
    }
    const int joint = static_cast<int>(j);
    if (joint == body.pelvis) body.bodies[j] = Body::pelvis;
    for (std::size_t s = 0; s < body.legs.size(); ++s) {
      const Leg& leg = body.legs[s];
      const Body own = joint == leg.upper   ? Body::upper
                       : joint == leg.lower ? Body::lower
                       : joint == leg.foot  ? Body::foot
                       : joint == leg.toes  ? Body::toes
                                            : Body::none;
      if (own == Body::none) continue;
      body.bodies[j] = own;
      body.side[j] = static_cast<std::uint8_t>(s);
    }
  }
  return body;
}

}  // namespace krok::plant
