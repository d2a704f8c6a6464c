#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "math/quaternion.h"
#include "scene/clip.h"
#include "scene/model.h"
#include "support/human_skeleton.h"

// Models and motions for tests of skinning and of the formats that carry them.

namespace krok::test {

// The same joint positions with rotated reference orientations, so that mixed-up frames are
// detected.
inline Skeleton with_turned_joints(Skeleton skeleton) {
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    skeleton.reference[j].orientation =
        from_rotation_vector(Vec3(std::sin(1.0 + j), std::cos(2.0 * j), std::sin(3.0 * j + 0.5)));
  }
  return skeleton;
}

inline Skeleton turned_human() {
  return with_turned_joints(human_skeleton());
}

// Every joint swings about a different axis, the root walks along +Z.
inline Clip swinging_clip(const Skeleton& skeleton, int frames, double rate) {
  Clip clip;
  clip.skeleton = skeleton;
  clip.rate = rate;
  clip.resize(frames);
  const auto joints = skeleton.names.size();
  std::vector<Transform> local(joints), world(joints);
  for (int f = 0; f < frames; ++f) {
    const double t = f / rate;
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      local[j] = skeleton.reference_local(j);
      const Vec3 axis = Vec3(std::sin(2.0 * j), std::cos(1.0 + j), std::sin(j + 0.3)).normalized();
      const double angle = 0.6 * std::sin(3.0 * t + 0.7 * j);
      local[j].orientation = local[j].orientation * from_rotation_vector(angle * axis);
    }
    local[0].position += Vec3(0.1 * std::sin(5 * t), 0.05 * std::cos(9 * t), 1.2 * t);
    local_to_world(skeleton.parents, local, world);
    clip.set_pose(f, world);
  }
  return clip;
}

inline Clip swinging_human(int frames) {
  return swinging_clip(human_skeleton(), frames, 30);
}

// A closed tube of `sides` corners and `rings` rings around every bone. Vertices follow the bone's
// joint and share weight with up to `influences` joints near its ends; 1 binds them rigidly.
inline Model tube_model(const Skeleton& skeleton, int influences = 4, int rings = 6,
                        int sides = 8) {
  Model model;
  model.skeleton = skeleton;
  model.influences_per_vertex = influences;
  for (int child = 1; child < skeleton.joint_count(); ++child) {
    const int joint = skeleton.parents[child];
    const Vec3 from = skeleton.reference[joint].position;
    const Vec3 along = skeleton.reference[child].position - from;
    if (along.norm() < 1e-6) continue;
    const Quat turn = shortest_arc(Vec3::UnitY(), along);
    const double radius = std::min(0.05, 0.3 * along.norm());
    const auto first = static_cast<std::uint32_t>(model.positions.size());
    for (int ring = 0; ring < rings; ++ring) {
      const double place = static_cast<double>(ring) / (rings - 1);
      for (int side = 0; side < sides; ++side) {
        const double angle = 2 * kPi * side / sides;
        const Vec3 out = turn * Vec3(std::sin(angle), 0, std::cos(angle));
        model.positions.push_back((from + place * along + radius * out).cast<float>());
        model.normals.push_back(out.cast<float>());
        model.texture_coordinates.emplace_back(static_cast<float>(side) / sides, place);
        // Ancestors and the child, with decreasing weights.
        int other = joint;
        for (int k = 0; k < influences; ++k) {
          const double weight = k == 0 ? 1.0 : 0.5 * (k % 2 == 1 ? 1 - place : place) / k;
          model.influence_joints.push_back(static_cast<std::uint16_t>(k == 1 ? child : other));
          model.influence_weights.push_back(static_cast<float>(weight));
          if (k != 1) other = std::max(0, skeleton.parents[other]);
        }
      }
    }
    const auto corner = [&](int ring, int side) {
      return first + static_cast<std::uint32_t>(ring * sides + side % sides);
    };
    for (int ring = 0; ring + 1 < rings; ++ring) {
      for (int side = 0; side < sides; ++side) {
        model.triangles.push_back(
            {corner(ring, side), corner(ring, side + 1), corner(ring + 1, side)});
        model.triangles.push_back(
            {corner(ring, side + 1), corner(ring + 1, side + 1), corner(ring + 1, side)});
      }
    }
    for (int side = 1; side + 1 < sides; ++side) {
      model.triangles.push_back({corner(0, 0), corner(0, side + 1), corner(0, side)});
      model.triangles.push_back(
          {corner(rings - 1, 0), corner(rings - 1, side), corner(rings - 1, side + 1)});
    }
  }
  normalize_influences(model);
  const auto count = static_cast<std::uint32_t>(model.triangles.size());
  model.parts = {{"tubes", "", 0, count}};
  return model;
}

}  // namespace krok::test
