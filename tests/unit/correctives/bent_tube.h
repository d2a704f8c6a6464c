#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/index.h"
#include "correctives/fit_correctives.h"
#include "math/quaternion.h"

// A closed tube of two bones along +X with a joint at the origin, and its poses.

namespace krok::test {

inline constexpr int kTubeRings = 33, kTubeSides = 16;
inline constexpr double kTubeRadius = 0.045, kTubeLength = 0.2;  // metres, of each bone

inline Model bent_tube() {
  Model model;
  model.skeleton.add("upper", -1, {Vec3(-kTubeLength, 0, 0), Quat::Identity()});
  model.skeleton.add("lower", 0, {Vec3::Zero(), from_rotation_vector(Vec3(0.3, -0.2, 0.5))});
  model.skeleton.add("tip", 1, {Vec3(kTubeLength, 0, 0), Quat::Identity()}, true);
  model.influences_per_vertex = 2;
  const auto add = [&](const Vec3& position, const Vec3& normal) {
    const double t = std::clamp((position.x() + 0.06) / 0.12, 0.0, 1.0);
    const double lower = t * t * (3 - 2 * t);
    const bool is_lower = lower > 0.5;
    const auto weight = static_cast<float>(is_lower ? lower : 1 - lower);
    model.positions.push_back(position.cast<float>());
    model.normals.push_back(normal.cast<float>());
    model.influence_joints.push_back(is_lower ? 1 : 0);
    model.influence_joints.push_back(!is_lower && weight < 1 ? 1 : 0);
    model.influence_weights.push_back(weight);
    model.influence_weights.push_back(1 - weight);
  };
  for (int ring = 0; ring < kTubeRings; ++ring) {
    const double x = kTubeLength * (2.0 * ring / (kTubeRings - 1) - 1) * 0.99;
    for (int side = 0; side < kTubeSides; ++side) {
      const double angle = 2 * kPi * side / kTubeSides;
      const Vec3 out(0, std::cos(angle), std::sin(angle));
      add(Vec3(x, 0, 0) + kTubeRadius * out, out);
    }
  }
  const auto first = static_cast<std::uint32_t>(model.positions.size());
  add(Vec3(-kTubeLength, 0, 0), -Vec3::UnitX());
  add(Vec3(kTubeLength, 0, 0), Vec3::UnitX());
  const auto at = [](int ring, int side) {
    return static_cast<std::uint32_t>(ring * kTubeSides + side % kTubeSides);
  };
  for (int side = 0; side < kTubeSides; ++side) {
    model.triangles.push_back({first, at(0, side + 1), at(0, side)});
    for (int ring = 0; ring + 1 < kTubeRings; ++ring) {
      model.triangles.push_back({at(ring, side), at(ring, side + 1), at(ring + 1, side)});
      model.triangles.push_back({at(ring + 1, side), at(ring, side + 1), at(ring + 1, side + 1)});
    }
    model.triangles.push_back({at(kTubeRings - 1, side), at(kTubeRings - 1, side + 1), first + 1});
  }
  model.parts.push_back({"tube", "", 0, static_cast<std::uint32_t>(model.triangles.size())});
  return model;
}

// The tube with the lower bone turned by a rotation vector about the joint, in the world.
inline std::vector<Transform> bent(const Model& tube, const Vec3& rotation) {
  std::vector<Transform> pose = tube.skeleton.reference;
  const Quat turn = from_rotation_vector(rotation);
  for (std::size_t j : {1u, 2u}) pose[j] = {turn * pose[j].position, turn * pose[j].orientation};
  return pose;
}

inline std::vector<Vec3f> skinned_tube(const Model& tube, SkinMethod method,
                                       const std::vector<Transform>& pose) {
  const SkinBinding binding(tube, method);
  SkinPose posed(binding);
  posed.set(pose);
  std::vector<Vec3f> moved(tube.positions.size());
  skin(binding, posed, {tube.positions, {}, {}}, {moved, {}, {}});
  return moved;
}

// The sculpt: dual quaternion skinning.
inline SculptedPose sculpted(const Model& tube, const Vec3& rotation) {
  SculptedPose pose;
  pose.joint_to_world = bent(tube, rotation);
  pose.positions = skinned_tube(tube, SkinMethod::dual_quaternion, pose.joint_to_world);
  return pose;
}

}  // namespace krok::test
