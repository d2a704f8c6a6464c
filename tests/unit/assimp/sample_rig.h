#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "math/transform.h"

// A small rig that moves and a mesh on it, for the samples of files; and where its joints are, by
// plain forward kinematics.

namespace krok::test {

// Rotations are of angles about x, then y, then z, each about the parent's axes, in radians.
struct Pose {
  Vec3 translation = Vec3::Zero();
  Vec3 angles = Vec3::Zero();

  Quat rotation() const {
    return Quat(Eigen::AngleAxisd(angles[2], Vec3::UnitZ()) *
                Eigen::AngleAxisd(angles[1], Vec3::UnitY()) *
                Eigen::AngleAxisd(angles[0], Vec3::UnitX()));
  }
  Transform transform() const { return {translation, rotation()}; }
};

// Joint 2 rests in every frame, in a pose that is not the mesh's.
struct MovingRig {
  std::vector<std::string> names = {"Hips", "Spine", "Head"};
  std::vector<int> parents = {-1, 0, 1};
  std::vector<Pose> rest = {{{0.1, 0.2, 1.0}, {0.1, -0.2, 0.3}},
                            {{0.0, 0.3, 0.5}, {0.7, 0.4, -0.5}},
                            {{0.1, 0.0, 0.4}, {0.0, 0.2, 0.1}}};
  std::vector<std::vector<Pose>> frames;  // [frames][joints]

  MovingRig() {
    for (int f = 0; f < 4; ++f) {
      std::vector<Pose> poses = rest;
      poses[0].translation += Vec3(0.1 * f, 0.02 * f * f, -0.05 * f);
      poses[0].angles += Vec3(0.2 * f, 0.1, -0.3 * f);
      poses[1].angles += Vec3(-0.4 * f, 0.3 * f, 0.5 * f);
      poses[2].translation = {0.2, 0.1, 0.3};
      poses[2].angles = {0.3, -0.6, 0.9};
      frames.push_back(std::move(poses));
    }
  }

  std::vector<Transform> to_world(const std::vector<Pose>& poses) const {
    std::vector<Transform> world;
    for (std::size_t j = 0; j < poses.size(); ++j) {
      const Transform local = poses[j].transform();
      world.push_back(parents[j] < 0 ? local : world[static_cast<std::size_t>(parents[j])] * local);
    }
    return world;
  }
};

// Weights of the four corners of the mesh, a list of joint and weight each.
inline const std::vector<std::vector<std::pair<int, double>>>& corner_weights() {
  static const std::vector<std::vector<std::pair<int, double>>> weights = {
      {{0, 1.0}}, {{0, 0.25}, {1, 0.75}}, {{1, 0.5}, {2, 0.3}, {0, 0.2}}, {{2, 1.0}}};
  return weights;
}
inline const std::vector<Vec3>& corners() {
  static const std::vector<Vec3> places = {
      {0, 0, 0.9}, {0.3, 0, 1.2}, {0.1, 0.5, 1.6}, {-0.2, 0.4, 1.9}};
  return places;
}
inline const std::vector<std::array<int, 3>>& corner_triangles() {
  static const std::vector<std::array<int, 3>> triangles = {{0, 1, 2}, {0, 2, 3}};
  return triangles;
}

}  // namespace krok::test
