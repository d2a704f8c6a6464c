#pragma once

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "math/quaternion.h"
#include "retarget/retarget.h"
#include "support/human_skeleton.h"
#include "support/test_scenes.h"

// Skeletons and motions that tests of retargeting vary.

namespace krok::test {

inline std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

// The skeleton with a joint and all below it turned about its own place in the reference pose.
inline Skeleton posed(Skeleton skeleton, const std::string& joint, const Quat& turn) {
  const int root = skeleton.find(joint);
  const Vec3 pivot = skeleton.reference[at(root)].position;
  std::vector<char> inside(skeleton.names.size(), 0);
  for (int j = root; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.parents[at(j)];
    inside[at(j)] = j == root || (parent >= 0 && inside[at(parent)] != 0) ? 1 : 0;
    if (inside[at(j)] == 0) continue;
    Transform& transform = skeleton.reference[at(j)];
    transform.position = pivot + turn * (transform.position - pivot);
    transform.orientation = turn * transform.orientation;
  }
  return skeleton;
}

// The same figure with other axes in every joint, and the names of another exporter, so that it
// passes for no copy.
inline Skeleton with_other_axes(const Skeleton& from, unsigned seed) {
  Skeleton skeleton = from;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Vec3 turn(normal(random), normal(random), normal(random));
    skeleton.reference[at(j)].orientation =
        skeleton.reference[at(j)].orientation * from_rotation_vector(turn);
    skeleton.names[at(j)] = "rig:" + skeleton.names[at(j)];
  }
  return skeleton;
}

inline Skeleton scaled(Skeleton skeleton, double scale) {
  for (Transform& joint : skeleton.reference) joint.position *= scale;
  return skeleton;
}

// A motion in which every joint bends, elbows and knees the way that they can, over a floor: feet
// swing over y = 0, the figure walks ahead and turns.
inline Clip lively_clip(const Skeleton& skeleton, int frames = 40) {
  Clip clip;
  clip.skeleton = skeleton;
  clip.rate = 30;
  clip.resize(frames);
  std::vector<Transform> local(skeleton.names.size()), world(skeleton.names.size());
  for (int f = 0; f < frames; ++f) {
    const double t = f / 30.0;
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const std::string& name = skeleton.names[at(j)];
      const bool left = name.find("Left") != std::string::npos;
      const double side = left ? 1 : -1;
      const double swing = std::sin(5 * t + (left ? 0 : kPi));
      Vec3 turn = 0.1 * Vec3(std::sin(t + j), std::cos(2 * t + j), std::sin(3 * t));
      if (name.find("UpLeg") != std::string::npos)
        turn = Vec3(-0.5 * swing, 0.1, 0.05 * side);
      else if (name.find("Leg") != std::string::npos)
        turn = Vec3(0.5 + 0.4 * swing, 0, 0);
      else if (name.find("ForeArm") != std::string::npos)
        turn = Vec3(0.2, -side * (0.6 + 0.4 * swing), 0);
      else if (name.find("Arm") != std::string::npos)
        turn = Vec3(0.3 * swing, 0.2 * side, -side * 1.1);
      // Turns are about the axes of the world in the reference pose, whatever the joint's axes.
      const Quat rest = skeleton.reference[at(j)].orientation;
      local[at(j)] = skeleton.reference_local(j);
      local[at(j)].orientation =
          local[at(j)].orientation * rest.conjugate() * from_rotation_vector(turn) * rest;
    }
    local[0].position += Vec3(0.2 * std::sin(t), 0.03 * std::cos(9 * t), 1.2 * t);
    local[0].orientation = from_rotation_vector(Vec3(0, 0.7 * t, 0)) * local[0].orientation;
    local_to_world(skeleton.parents, local, world);
    clip.set_pose(f, world);
  }
  return clip;
}

// A motion without frames: a target that is only a skeleton.
inline Clip resting(const Skeleton& skeleton) {
  Clip clip;
  clip.skeleton = skeleton;
  return clip;
}

inline Result<retarget::Retargeted> transfer(const Clip& source, const Clip& target,
                                             const retarget::Options& options = {}) {
  return retarget::transfer(source, find_roles(source.skeleton), target,
                            find_roles(target.skeleton), options);
}

inline Result<retarget::Retargeted> transfer(const Clip& source, const Skeleton& target,
                                             const retarget::Options& options = {}) {
  return transfer(source, resting(target), options);
}

// The largest distance between joints of two motions, the second's positions scaled; joints in the
// same order.
inline double largest_distance(const Clip& a, const Clip& b, double scale = 1) {
  double largest = 0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    largest = std::max(
        largest, (a.positions[i].cast<double>() - scale * b.positions[i].cast<double>()).norm());
  }
  return largest;
}

// The direction of a bone in a frame, by the names of its joints.
inline Vec3 bone(const Clip& clip, int frame, const std::string& from, const std::string& to) {
  const auto positions = clip.frame_positions(frame);
  return (positions[at(clip.skeleton.find(to))] - positions[at(clip.skeleton.find(from))])
      .cast<double>()
      .normalized();
}

inline double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kRadiansPerDegree;
}

}  // namespace krok::test
