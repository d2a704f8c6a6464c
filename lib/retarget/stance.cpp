#include "retarget/stance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "retarget/actor_view_internal.h"
#include "roles/roles.h"
#include "scene/frame_blocks.h"

namespace krok::retarget {

namespace {

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

  // Whether trunk and legs lie along one line, whichever way it points.
  bool in_line() const { return least_along(trunk()) > 0.5; }

 private:
  const Vec3& place(int joint) const {
    return actor_.pose[static_cast<std::size_t>(joint)].position;
  }
  const Actor& actor_;
};

}  // namespace

bool stands(const Actor& actor) {
  return Posture(actor).least_along(Vec3::UnitY()) > 0.5;
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
  const Actor actor{clip.skeleton, roles, clip.skeleton.reference};
  if (!roles.humanoid || stands(actor)) return stance;
  stance.pose = build_stance(clip, roles, !Posture(actor).in_line());
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

}  // namespace krok::retarget
