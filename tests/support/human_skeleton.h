#pragma once

#include <string>

#include "scene/skeleton.h"

// A human skeleton for tests: 1.75 m tall, T-pose, facing +Z, feet at y = 0, exactly mirror
// symmetric, with the proportions of Drillis and Contini (in Winter, Biomechanics and Motor Control
// of Human Movement): thigh 0.245, shank 0.246, upper arm 0.186, forearm 0.146 of the stature.

namespace krok::test {

inline Skeleton human_skeleton(double stature = 1.75) {
  Skeleton skeleton;
  const auto add = [&](const std::string& name, int parent, double x, double y, double z,
                       bool end = false) {
    Transform transform;
    transform.position = stature * Vec3(x, y, z);
    return skeleton.add(name, parent, transform, end);
  };
  const int hips = add("Hips", -1, 0, 0.55, 0);
  const int spine = add("Spine", hips, 0, 0.60, 0);
  const int spine1 = add("Spine1", spine, 0, 0.68, 0);
  const int chest = add("Spine2", spine1, 0, 0.74, 0);
  const int neck = add("Neck", chest, 0, 0.845, 0);
  const int head = add("Head", neck, 0, 0.885, 0.005);
  add("Head_end", head, 0, 1.0, 0.005, true);
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "Left" : "Right";
    const int shoulder = add(name + "Shoulder", chest, 0.02 * side, 0.81, 0);
    const int arm = add(name + "Arm", shoulder, 0.105 * side, 0.815, 0);
    const int forearm = add(name + "ForeArm", arm, 0.291 * side, 0.815, 0);
    const int hand = add(name + "Hand", forearm, 0.437 * side, 0.815, 0);
    add(name + "Hand_end", hand, 0.50 * side, 0.815, 0, true);
  }
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "Left" : "Right";
    const int thigh = add(name + "UpLeg", hips, 0.052 * side, 0.53, 0);
    const int shank = add(name + "Leg", thigh, 0.052 * side, 0.285, 0);
    const int foot = add(name + "Foot", shank, 0.052 * side, 0.039, 0);
    const int toes = add(name + "ToeBase", foot, 0.055 * side, 0.010, 0.075);
    add(name + "ToeBase_end", toes, 0.056 * side, 0.008, 0.112, true);
  }
  return skeleton;
}

}  // namespace krok::test
