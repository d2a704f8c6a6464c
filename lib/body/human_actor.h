#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "roles/roles.h"
#include "scene/skeleton.h"

// Where the landmarks of a human body are in a skeleton.

namespace krok::body {

struct HumanActor {
  struct Arm {
    int collar = -1;  // or -1
    int shoulder = -1, elbow = -1, wrist = -1;
    // Chains of joints from the hand on, end sites included, each from its first joint away from
    // the wrist to its tip; thumb and fingers, as far as the skeleton has them.
    std::vector<std::vector<int>> fingers;
  };
  struct Leg {
    int hip = -1, knee = -1, ankle = -1;
    int toes = -1;  // the ball of the foot, or -1
    // A joint or end site beyond it, or beyond the ankle where there is no ball; or -1.
    int tip = -1;
    // A joint right under the ankle that carries the foot, where the skeleton has that; or -1.
    int sole = -1;
  };
  int hips = -1;
  int neck = -1, head = -1;  // one of them may be -1
  int head_top = -1;         // the child of the head that lies farthest up, or -1
  std::array<Arm, 2> arms;   // left, right
  std::array<Leg, 2> legs;
  double stature = 0;  // metres, from the lengths of the bones
};

// The landmarks, if the roles make a human and the lengths of its bones are such that a human body
// can be put around them; nothing otherwise.
std::optional<HumanActor> find_human(const Skeleton& skeleton, const RoleMap& roles);

// Unit vectors of a posed figure: up along the trunk, left across hips and shoulders, forward.
struct HumanAxes {
  Vec3 up = Vec3::UnitY(), left = Vec3::UnitX(), forward = Vec3::UnitZ();
};
HumanAxes human_axes(const HumanActor& actor, std::span<const Transform> pose);

// The joints on the way from `ancestor` to `joint`, both included; only `joint` if it is no
// descendant.
std::vector<int> joint_path(const Skeleton& skeleton, int ancestor, int joint);

}  // namespace krok::body
