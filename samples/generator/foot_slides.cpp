#include "samples/generator/foot_slides.h"

#include <algorithm>

#include "ik/two_bone.h"
#include "samples/generator/noise.h"

namespace krok::samples {

namespace {

Transform joint_in(const Clip& clip, int frame, int joint) {
  return {
      clip.frame_positions(frame)[static_cast<std::size_t>(joint)].cast<double>(),
      clip.frame_orientations(frame)[static_cast<std::size_t>(joint)].cast<double>().normalized()};
}

double eased(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

}  // namespace

std::array<LegRoles, 2> legs_of(const RoleMap& roles) {
  return {LegRoles{roles.joint(Role::left_upper_leg), roles.joint(Role::left_lower_leg),
                   roles.joint(Role::left_foot)},
          LegRoles{roles.joint(Role::right_upper_leg), roles.joint(Role::right_lower_leg),
                   roles.joint(Role::right_foot)}};
}

bool move_foot(Clip& clip, int frame, const LegRoles& leg, const Vec3& shift,
               bool as_far_as_it_reaches) {
  const Transform upper = joint_in(clip, frame, leg.upper),
                  lower = joint_in(clip, frame, leg.lower), foot = joint_in(clip, frame, leg.foot);
  const TwoBoneSolution solution = solve_two_bone(
      {upper.position, lower.position, foot.position, Vec3::Zero()}, {foot.position + shift});
  if (!solution.reached && !as_far_as_it_reaches) return false;
  std::vector<int> part(clip.skeleton.names.size(), 0);
  for (std::size_t j = 0; j < part.size(); ++j) {
    const int parent = clip.skeleton.parents[j], joint = static_cast<int>(j);
    if (parent >= 0) part[j] = part[static_cast<std::size_t>(parent)];
    part[j] = joint == leg.upper ? 1 : joint == leg.lower ? 2 : joint == leg.foot ? 3 : part[j];
    if (part[j] == 0) continue;
    const Quat turn = part[j] == 1   ? solution.root_rotation
                      : part[j] == 2 ? solution.middle_rotation
                                     : Quat::Identity();
    const Vec3 from = part[j] == 1 ? upper.position : part[j] == 2 ? lower.position : foot.position;
    const Vec3 to = part[j] == 1 ? upper.position : part[j] == 2 ? solution.middle : solution.end;
    const Transform now = joint_in(clip, frame, joint);
    clip.frame_positions(frame)[j] = (to + turn * Vec3(now.position - from)).cast<float>();
    clip.frame_orientations(frame)[j] = (turn * now.orientation).cast<float>();
  }
  return solution.reached;
}

std::vector<Stance> stances_of(const Walk& walk) {
  std::vector<Stance> stances;
  for (const Footprint& print : walk.prints) {
    stances.push_back({static_cast<std::size_t>(print.side), print.strike, print.off});
  }
  return stances;
}

Vec3 slide_at(std::span<const Stance> stances, std::span<const Vec3> directions, std::size_t side,
              double time) {
  constexpr double kSwing = 0.2;  // seconds
  Vec3 slide = Vec3::Zero();
  for (std::size_t i = 0; i < stances.size(); ++i) {
    const Stance& stance = stances[i];
    if (stance.side != side) continue;
    slide += (eased((time - stance.start) / (stance.end - stance.start)) -
              eased((time - stance.end) / kSwing)) *
             directions[i];
  }
  return slide;
}

void move_foot_within_reach(Clip& clip, int frame, const LegRoles& leg, Vec3 shift) {
  for (int i = 0; i < 6 && !shift.isZero(); ++i, shift *= 0.7) {
    if (move_foot(clip, frame, leg, shift)) return;
  }
}

Clip with_slides(const Walk& walk, double slide, std::uint64_t seed) {
  Clip clip = walk.clip;
  const std::vector<Stance> stances = stances_of(walk);
  NoiseSource random(seed);
  std::vector<Vec3> directions;
  for (std::size_t i = 0; i < stances.size(); ++i) {
    const double x = random.gaussian(), z = random.gaussian();
    directions.push_back(Vec3(x, 0, z).stableNormalized());
  }
  const auto legs = legs_of(find_roles(clip.skeleton));
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (const std::size_t side : {0U, 1U}) {
      move_foot_within_reach(clip, f, legs[side],
                             slide * slide_at(stances, directions, side, f / clip.rate));
    }
  }
  return clip;
}

}  // namespace krok::samples
