#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "roles/roles.h"
#include "scene/skeleton.h"

// The landmarks of a human body in a skeleton.

namespace krok::body {

struct HumanActor {
  struct Arm {
    int collar = -1;  // -1 if none
    int shoulder = -1, elbow = -1, wrist = -1;
    // Joint chains of thumb and fingers, if any, each from its first joint after the wrist to the
    // tip, including end sites.
    std::vector<std::vector<int>> fingers;
  };
  struct Leg {
    int hip = -1, knee = -1, ankle = -1;
    int toes = -1;  // the ball of the foot, or -1
    // A joint or end site beyond the ball, or beyond the ankle if there is no ball; or -1.
    int tip = -1;
    // A joint directly below the ankle that carries the foot, or -1.
    int sole = -1;
  };
  int hips = -1;
  int neck = -1, head = -1;  // one of them may be -1
  int head_top = -1;         // the highest child of the head, or -1
  std::array<Arm, 2> arms;   // left, right
  std::array<Leg, 2> legs;
  double stature = 0;  // scale of the drawn body: the median of what single bones give, metres
};

// The landmarks, if the joint roles form a human and a human body fits the bone lengths; nullopt
// otherwise, and for an animal on four legs whose joints have a person's names.
std::optional<HumanActor> find_human(const Skeleton& skeleton, const RoleMap& roles);

// Unit vectors of a posed body: up along the trunk, left across hips and shoulders, forward.
struct HumanAxes {
  Vec3 up = Vec3::UnitY(), left = Vec3::UnitX(), forward = Vec3::UnitZ();
};
HumanAxes human_axes(const HumanActor& actor, std::span<const Transform> pose);

// The joints on the path from `ancestor` to `joint`, both included; only `joint` if it is not a
// descendant.
std::vector<int> joint_path(const Skeleton& skeleton, int ancestor, int joint);

// Rotates a joint and its descendants about the joint's position, in world space.
void turn_joint(const Skeleton& skeleton, int joint, const Quat& rotation,
                std::span<Transform> joint_to_world);

// The angle between two vectors, radians in [0, pi]; 0 if either is zero.
double turn_angle(const Vec3& a, const Vec3& b);

}  // namespace krok::body
