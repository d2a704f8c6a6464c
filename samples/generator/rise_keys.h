#pragma once

#include <array>
#include <span>

#include "math/transform.h"
#include "samples/generator/rise.h"

// What a body does at moments of getting up; an actor of 1.75 m, metres and degrees.

namespace krok::samples {

struct LimbKey {
  Vec3 place = Vec3::Zero();  // of the wrist; of the ball of the foot, or of the ankle if it hangs
  Vec3 pole = Vec3::Zero();   // where the elbow or the knee points
  double hangs = 0;  // 1: hand or foot go along with the limb; 0: flat, or pitched by `pitch`
  double pitch = 0;  // of a foot: 0 flat, 90 on its toes; hanging: how far it is pointed
};

struct RiseKey {
  double time = 0;
  Vec3 pelvis = Vec3::Zero();
  double pitch = 0;  // forwards: 90 lies on the front, -90 on the back
  double turn = 0;   // about the trunk: -90 at a pitch of 90 lies on the left side
  double spine = 0;  // bend forwards from the pelvis to the chest
  double head = 0;   // bend forwards from the chest to the head
  std::array<LimbKey, 2> hands, feet;  // [Side]
};

std::span<const RiseKey> rise_keys(Lying from);

}  // namespace krok::samples
