#include "retarget/stance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "retarget/actor_view_internal.h"
#include "roles/roles.h"
#include "scene/frame_source.h"

namespace krok::retarget {

namespace {

constexpr double kThighsApart = 15 * kRadiansPerDegree, kKneesApart = 15 * kRadiansPerDegree;

double angle_of(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

class Posture {
 public:
  explicit Posture(const Actor& actor) : actor_(actor) {}

  // The unit direction from one role's joint to another's; zero if either is missing.
  Vec3 bone(Role from, Role to) const {
    const int a = actor_.roles.joint(from);
    const int b = actor_.roles.joint(to);
    if (a < 0 || b < 0) return Vec3::Zero();
    return (place(b) - place(a)).stableNormalized();
  }

  Vec3 trunk() const {
    return bone(Role::hips, actor_.roles.joint(Role::head) >= 0 ? Role::head : Role::neck);
  }

  // The cosine of the largest angle of trunk, thighs and shanks with a direction.
  double least_along(const Vec3& up) const {
    double least = trunk().dot(up);
    for (const LegRoles& leg : kLegRoles) {
      least = std::min(
          {least, -bone(leg.upper, leg.lower).dot(up), -bone(leg.lower, leg.foot).dot(up)});
    }
    return least;
  }

  bool stands() const { return least_along(Vec3::UnitY()) > 0.5 && !steps(); }

  // Whether the legs are apart or bent as in a step, which is a frame of a motion: what programs
  // write that have no other reference pose.
  bool steps() const {
    std::array<Vec3, 2> thighs;
    double largest = 0, least = kPi;  // bends of the knees
    for (std::size_t side = 0; side < 2; ++side) {
      const LegRoles& leg = kLegRoles[side];
      thighs[side] = bone(leg.upper, leg.lower);
      const double bend = angle_of(thighs[side], bone(leg.lower, leg.foot));
      largest = std::max(largest, bend);
      least = std::min(least, bend);
    }
    const Vec3 aside = bone(Role::right_upper_leg, Role::left_upper_leg);
    for (Vec3& thigh : thighs) thigh -= aside.dot(thigh) * aside;
    return angle_of(thighs[0], thighs[1]) > kThighsApart || largest - least > kKneesApart;
  }

  // Whether limbs of an upright body differ between the sides.
  bool is_lopsided() const {
    constexpr double kApart = 20 * kRadiansPerDegree;
    constexpr std::array<std::array<Role, 4>, 4> kBones = {{
        {Role::left_upper_leg, Role::left_lower_leg, Role::right_upper_leg, Role::right_lower_leg},
        {Role::left_lower_leg, Role::left_foot, Role::right_lower_leg, Role::right_foot},
        {Role::left_upper_arm, Role::left_lower_arm, Role::right_upper_arm, Role::right_lower_arm},
        {Role::left_lower_arm, Role::left_hand, Role::right_lower_arm, Role::right_hand},
    }};
    const Vec3 aside = (bone(Role::right_upper_leg, Role::left_upper_leg) +
                        bone(Role::right_upper_arm, Role::left_upper_arm))
                           .stableNormalized();
    if (trunk().y() < 0.5) return false;
    return std::ranges::any_of(kBones, [&](const std::array<Role, 4>& ends) {
      const Vec3 left = bone(ends[0], ends[1]), right = bone(ends[2], ends[3]);
      return !left.isZero() && !right.isZero() &&
             angle_of(left - 2 * aside.dot(left) * aside, right) > kApart;
    });
  }

  // Whether trunk and legs lie along one line, whichever way it points.
  bool in_line() const { return least_along(trunk()) > 0.5; }

 private:
  const Vec3& place(int joint) const {
    return actor_.pose[static_cast<std::size_t>(joint)].position;
  }
  const Actor actor_;
};

}  // namespace

bool stands(const Actor& actor) {
  return Posture(actor).stands();
}

bool is_straight(const Actor& actor) {
  return Posture(actor).in_line();
}

Result<Stance> stance_of_frame(const FrameSource& source, int frame) {
  if (frame < 0 || frame >= source.frame_count) {
    return Error("retarget-frame",
                 fmt::format("no frame {} to use as reference pose; the motion has {} frames, "
                             "numbered from 0",
                             frame, source.frame_count));
  }
  const auto clip = load(part_of(source, frame, 1), 1);
  if (!clip) return clip.error();
  Stance stance{source.skeleton.reference, frame};
  clip->get_pose(0, stance.pose);
  return stance;
}

Result<Stance> find_stance(const Clip& clip, const RoleMap& roles, std::optional<int> frame) {
  if (frame) return stance_of_frame(frames_of(clip), *frame);
  Stance stance{clip.skeleton.reference, {}};
  const Posture posture({clip.skeleton, roles, clip.skeleton.reference});
  if (!roles.humanoid || posture.stands()) return stance;
  stance.pose = build_stance(clip, roles, posture.steps() || !posture.in_line());
  return stance;
}

Skeleton neutral_skeleton(const Clip& clip, const RoleMap& roles) {
  Skeleton neutral = clip.skeleton;
  const Actor actor{clip.skeleton, roles, neutral.reference};
  if (roles.humanoid && !Posture(actor).in_line()) {
    neutral.reference = build_stance(clip, roles, true);
  }
  return neutral;
}

Result<Skeleton> neutral_skeleton(const FrameSource& source, const RoleMap& roles) {
  const auto looked_at = frames_looked_at(source);
  if (!looked_at) return looked_at.error();
  return neutral_skeleton(*looked_at, roles);
}

bool is_frame_of_motion(const Skeleton& skeleton, const RoleMap& roles) {
  return roles.humanoid && Posture({skeleton, roles, skeleton.reference}).is_lopsided();
}

std::vector<Transform> stance_from_frame(const Clip& clip, const RoleMap& roles) {
  return build_stance_from_frame(clip, roles);
}

Result<Clip> frames_looked_at(const FrameSource& source) {
  Clip looked_at{source.skeleton, source.rate, {}, {}, {}};
  const int step = step_in_take(source.frame_count);
  for (int f = 0; f < source.frame_count; f += step) {
    const auto frame = load(part_of(source, f, 1), 1);
    if (!frame) return frame.error();
    looked_at.positions.insert(looked_at.positions.end(), frame->positions.begin(),
                               frame->positions.end());
    looked_at.orientations.insert(looked_at.orientations.end(), frame->orientations.begin(),
                                  frame->orientations.end());
  }
  return looked_at;
}

}  // namespace krok::retarget
