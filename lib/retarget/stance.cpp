#include "retarget/stance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "math/quaternion.h"
#include "retarget/actor_measure_internal.h"

namespace krok::retarget {

namespace {

constexpr int kMaxFrames = 2000;

struct Side {
  Role upper_arm, lower_arm, hand, upper_leg, lower_leg, foot;
};
constexpr std::array kSides = {
    Side{Role::left_upper_arm, Role::left_lower_arm, Role::left_hand, Role::left_upper_leg,
         Role::left_lower_leg, Role::left_foot},
    Side{Role::right_upper_arm, Role::right_lower_arm, Role::right_hand, Role::right_upper_leg,
         Role::right_lower_leg, Role::right_foot}};

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
    for (const Side& side : kSides) {
      least = std::min({least, -bone(side.upper_leg, side.lower_leg).dot(up),
                        -bone(side.lower_leg, side.foot).dot(up)});
    }
    return least;
  }

  // Similarity of the pose to standing with arms to the sides, feet side by side.
  double likeness() const {
    const Vec3 left = bone(Role::right_upper_leg, Role::left_upper_leg);
    double sum = trunk().y();
    double outward = 1;
    for (const Side& side : kSides) {
      sum -= bone(side.upper_leg, side.lower_leg).y() + bone(side.lower_leg, side.foot).y();
      sum += 0.5 * outward *
             (bone(side.upper_arm, side.lower_arm) + bone(side.lower_arm, side.hand)).dot(left);
      outward = -1;
    }
    const Vec3 apart = bone(Role::right_foot, Role::left_foot);
    return sum + 2 * apart.dot(left);
  }

 private:
  const Vec3& place(int joint) const {
    return actor_.pose[static_cast<std::size_t>(joint)].position;
  }
  const Actor& actor_;
};

// Rotates a joint and its descendants about its position.
void turn_branch(const Skeleton& skeleton, int joint, const Quat& turn, std::span<Transform> pose) {
  std::vector<char> inside(skeleton.names.size(), 0);
  inside[static_cast<std::size_t>(joint)] = 1;
  const Vec3 pivot = pose[static_cast<std::size_t>(joint)].position;
  for (std::size_t j = static_cast<std::size_t>(joint); j < inside.size(); ++j) {
    const int parent = skeleton.parents[j];
    if (parent >= 0 && inside[static_cast<std::size_t>(parent)] != 0) inside[j] = 1;
    if (inside[j] == 0) continue;
    pose[j].position = pivot + turn * (pose[j].position - pivot);
    pose[j].orientation = (turn * pose[j].orientation).normalized();
  }
}

// Gives the legs of a pose a stance: straight down, each foot as flat as in the frame in which it
// is lowest, pointing forward.
class LegStraightener {
 public:
  LegStraightener(const Clip& clip, const RoleMap& roles, int step)
      : clip_(clip), roles_(roles), step_(step) {}

  void straighten(std::vector<Transform>& pose) const {
    for (const Side& side : kSides) {
      const int upper = roles_.joint(side.upper_leg);
      const int lower = roles_.joint(side.lower_leg);
      const int foot = roles_.joint(side.foot);
      point_down(upper, lower, pose);
      point_down(lower, foot, pose);
      flatten(foot, foot_front(clip_.skeleton, roles_, side.foot), pose);
    }
  }

 private:
  static std::size_t at(int joint) { return static_cast<std::size_t>(joint); }

  void point_down(int joint, int next, std::vector<Transform>& pose) const {
    const Vec3 bone = pose[at(next)].position - pose[at(joint)].position;
    turn_branch(clip_.skeleton, joint, shortest_arc(bone, -Vec3::UnitY()), pose);
  }

  void flatten(int foot, int front, std::vector<Transform>& pose) const {
    double lowest = std::numeric_limits<double>::max();
    Quat flattest = pose[at(foot)].orientation;
    for (int f = 0; f < clip_.frame_count(); f += step_) {
      const auto positions = clip_.frame_positions(f);
      const double height = static_cast<double>(positions[at(foot)].y()) +
                            (front >= 0 ? positions[at(front)].y() : 0);
      if (height >= lowest) continue;
      lowest = height;
      flattest = clip_.frame_orientations(f)[at(foot)].cast<double>().normalized();
    }
    turn_branch(clip_.skeleton, foot, flattest * pose[at(foot)].orientation.conjugate(), pose);
    if (front < 0) return;
    const Vec3 left = flat(pose[at(roles_.joint(Role::left_upper_leg))].position -
                           pose[at(roles_.joint(Role::right_upper_leg))].position);
    const Vec3 now = flat(pose[at(front)].position - pose[at(foot)].position);
    const Vec3 ahead = left.cross(Vec3::UnitY());
    if (now.norm() < 1e-9 || ahead.norm() < 1e-9) return;
    const double yaw = std::atan2(now.cross(ahead).y(), now.dot(ahead));
    turn_branch(clip_.skeleton, foot, from_rotation_vector(yaw * Vec3::UnitY()), pose);
  }

  const Clip& clip_;
  const RoleMap& roles_;
  int step_;
};

}  // namespace

bool stands(const Actor& actor) {
  return Posture(actor).least_along(Vec3::UnitY()) > 0.5;
}

Result<Stance> find_stance(const Clip& clip, const RoleMap& roles, std::optional<int> frame) {
  Stance stance;
  stance.pose = clip.skeleton.reference;
  const int frames = clip.frame_count();
  if (frame) {
    if (*frame < 0 || *frame >= frames) {
      return Error("retarget-frame",
                   fmt::format("no frame {} to use as reference pose; the motion has {} frames, "
                               "numbered from 0",
                               *frame, frames));
    }
    clip.get_pose(*frame, stance.pose);
    stance.frame = frame;
    return stance;
  }
  if (!roles.humanoid || stands({clip.skeleton, roles, stance.pose})) return stance;
  std::vector<Transform> pose = stance.pose;
  double best = 0;
  const int step = 1 + frames / kMaxFrames;
  for (int f = 0; f < frames; f += step) {
    clip.get_pose(f, pose);
    const Actor actor{clip.skeleton, roles, pose};
    if (!stands(actor)) continue;
    const double likeness = Posture(actor).likeness();
    if (stance.frame && likeness <= best) continue;
    best = likeness;
    stance.frame = f;
    stance.pose = pose;
  }
  if (stance.frame) LegStraightener(clip, roles, step).straighten(stance.pose);
  return stance;
}

Skeleton neutral_skeleton(const Clip& clip, const RoleMap& roles) {
  Skeleton neutral = clip.skeleton;
  const Actor actor{clip.skeleton, roles, neutral.reference};
  const Posture posture(actor);
  if (!roles.humanoid || posture.least_along(posture.trunk()) > 0.5) return neutral;
  if (auto stance = find_stance(clip, roles, std::nullopt)) {
    neutral.reference = std::move(stance->pose);
  }
  return neutral;
}

}  // namespace krok::retarget
