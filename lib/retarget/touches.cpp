#include "retarget/touches.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "ik/soft_reach.h"
#include "math/window.h"
#include "retarget/actor_view_internal.h"
#include "retarget/foot_placement.h"

namespace krok::retarget {

namespace {

constexpr double kFade = 0.3;  // seconds, before and after a stay

// The palm's middle, from the wrist, world: half-way to the knuckles or the end of the hand.
std::optional<Vec3> palm_of(const ActorView& actor, const ArmRoles& arm) {
  const int wrist = actor.joint(arm.hand);
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const Finger finger :
       {Finger::index, Finger::middle, Finger::ring, Finger::little, Finger::all}) {
    const int found = actor.knuckle(arm.fingers, finger);
    if (found < 0) continue;
    sum += actor.place(found) - actor.place(wrist);
    ++count;
  }
  if (count > 0 && sum.norm() > 1e-9) return Vec3(0.5 * sum / count);
  const int child = actor.only_child(wrist);
  if (child < 0 || actor.place(child) == actor.place(wrist)) return std::nullopt;
  const Vec3 palm = 0.5 * (actor.place(child) - actor.place(wrist));
  // Files have ends of hands that are metres away.
  const int elbow = actor.joint(arm.lower);
  const bool is_far = elbow >= 0 && palm.norm() > (actor.place(wrist) - actor.place(elbow)).norm();
  return is_far ? std::nullopt : std::optional(palm);
}

BodyPoint beside_joint(const Actor& actor, int joint, const Vec3& off) {
  return {joint, actor.pose[at(joint)].orientation.conjugate() * off};
}

}  // namespace

Touch find_touch(std::span<const double> distance, std::span<const double> speed,
                 const TouchLimits& limits, double rate) {
  const int frames = static_cast<int>(distance.size());
  Touch touch;
  touch.weight.assign(distance.size(), 0);
  for (int f = 0; f < frames; ++f) {
    if (distance[at(f)] > limits.near || speed[at(f)] > limits.speed) continue;
    const bool goes_on = !touch.stays.empty() && touch.stays.back().last == f - 1;
    if (goes_on) {
      touch.stays.back().last = f;
    } else {
      touch.stays.push_back({f, f});
    }
  }
  std::erase_if(touch.stays,
                [&](const Stay& stay) { return stay.last - stay.first < limits.shortest * rate; });
  if (touch.stays.empty()) return touch;
  // Around each stay as long as it is not far, and not long before or after.
  const auto weigh = [&](int f, int from_stay) {
    const double weight = (1 - smooth_step(limits.near, limits.far, distance[at(f)])) *
                          (1 - smooth_step(0, kFade * rate, from_stay));
    touch.weight[at(f)] = std::max(touch.weight[at(f)], weight);
    return weight > 0;
  };
  for (const Stay& stay : touch.stays) {
    for (int f = stay.first; f <= stay.last; ++f) weigh(f, 0);
    for (int f = stay.first - 1; f >= 0 && weigh(f, stay.first - f);) --f;
    for (int f = stay.last + 1; f < frames && weigh(f, f - stay.last);) ++f;
  }
  touch.weight = softened(touch.weight, softening_reach(rate));
  return touch;
}

const char* name_of(BodyPart part) {
  constexpr std::array<const char*, kBodyParts> kNames = {"left hand",   "right hand", "left elbow",
                                                          "right elbow", "left knee",  "right knee",
                                                          "left foot",   "right foot", "hips"};
  return kNames[static_cast<std::size_t>(part)];
}

std::array<PointPair, kBodyParts> body_points(const Actor& source, const Actor& target) {
  std::array<PointPair, kBodyParts> points;
  const ActorView from(source), onto(target);
  const auto set = [&](BodyPart part, BodyPoint a, BodyPoint b) {
    if (a.joint >= 0 && b.joint >= 0) points[static_cast<std::size_t>(part)] = {a, b};
  };
  const auto set_joints = [&](BodyPart part, Role role) {
    set(part, at_joint(from.joint(role)), at_joint(onto.joint(role)));
  };
  const auto part_of = [](BodyPart left, std::size_t side) {
    return static_cast<BodyPart>(static_cast<std::size_t>(left) + side);
  };
  for (std::size_t side = 0; side < 2; ++side) {
    const ArmRoles& arm = kArmRoles[side];
    const LegRoles& leg = kLegRoles[side];
    set_joints(part_of(BodyPart::left_elbow, side), arm.lower);
    set_joints(part_of(BodyPart::left_knee, side), leg.lower);
    const BodyPart hand = part_of(BodyPart::left_hand, side);
    set_joints(hand, arm.hand);
    if (from.joint(arm.hand) >= 0 && onto.joint(arm.hand) >= 0) {
      const auto a = palm_of(from, arm), b = palm_of(onto, arm);
      if (a && b) {
        set(hand, beside_joint(source, from.joint(arm.hand), *a),
            beside_joint(target, onto.joint(arm.hand), *b));
      }
    }
    const BodyPart foot = part_of(BodyPart::left_foot, side);
    const auto a = first_toes(source.skeleton, source.roles, leg.foot);
    const auto b = first_toes(target.skeleton, target.roles, leg.foot);
    if (!a.empty() && !b.empty()) {
      set(foot, at_joint(a.front()), at_joint(b.front()));
    } else {
      set_joints(foot, leg.foot);
    }
  }
  set_joints(BodyPart::hips, Role::hips);
  return points;
}

std::vector<BodyBone> body_bones(const Actor& source, const Actor& target) {
  const ActorView from(source), onto(target);
  std::vector<BodyBone> bones;
  const auto add = [&](const char* name, Role a, Role b, double radius,
                       std::optional<bool> is_left = {}) {
    BodyBone bone{name,          from.joint(a), from.joint(b), onto.joint(a),
                  onto.joint(b), radius,        is_left};
    if (bone.from >= 0 && bone.to >= 0 && bone.onto_from >= 0 && bone.onto_to >= 0) {
      bones.push_back(bone);
    }
  };
  // Radii of a person of 1.75 m with some air: thigh 9 cm, shank 6, arm 5, head and trunk 13 to 15.
  add("trunk", Role::hips, Role::neck, 0.17);
  add("head", Role::neck, Role::head, 0.17);
  for (const bool is_left : {true, false}) {
    const LegRoles& leg = kLegRoles[is_left ? 0 : 1];
    const std::size_t before = bones.size();
    add(is_left ? "left thigh" : "right thigh", leg.upper, leg.lower, 0.12);
    if (bones.size() > before) bones.back().begins = 0.05;
  }
  add("left shank", Role::left_lower_leg, Role::left_foot, 0.09);
  add("right shank", Role::right_lower_leg, Role::right_foot, 0.09);
  add("left upper arm", Role::left_upper_arm, Role::left_lower_arm, 0.09, true);
  add("right upper arm", Role::right_upper_arm, Role::right_lower_arm, 0.09, false);
  add("left forearm", Role::left_lower_arm, Role::left_hand, 0.08, true);
  add("right forearm", Role::right_lower_arm, Role::right_hand, 0.08, false);
  return bones;
}

BesideLine beside_line(const Vec3& point, const Vec3& from, const Vec3& to) {
  const Vec3 line = to - from;
  const double square = line.squaredNorm();
  BesideLine beside;
  if (square > 0) beside.along = std::clamp((point - from).dot(line) / square, 0.0, 1.0);
  beside.off = point - (from + beside.along * line);
  return beside;
}

}  // namespace krok::retarget
