#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "draw/motion_charts.h"
#include "math/quaternion.h"
#include "support/human_skeleton.h"

// Motions for tests of charts, made joint by joint.

namespace krok::draw {

inline constexpr double kTight = 1e-3;  // degrees: positions are floats

inline Quat about(krok::Axis axis, double degrees) {
  return axis_rotation(axis, degrees * kRadiansPerDegree);
}

// Turns of joints against their parents, by name, on top of the reference pose.
using Turns = std::map<std::string, Quat>;

// One frame a pose, the whole figure placed by `place`.
inline Clip posed(const std::vector<Turns>& poses, const Transform& place = {}, double rate = 10) {
  Clip clip;
  clip.skeleton = test::human_skeleton();
  clip.rate = rate;
  clip.resize(static_cast<int>(poses.size()));
  const auto joints = clip.skeleton.names.size();
  for (std::size_t f = 0; f < poses.size(); ++f) {
    std::vector<Transform> pose(joints);
    for (std::size_t j = 0; j < joints; ++j) {
      pose[j] = clip.skeleton.reference_local(static_cast<int>(j));
      if (const auto turn = poses[f].find(clip.skeleton.names[j]); turn != poses[f].end()) {
        pose[j].orientation = pose[j].orientation * turn->second;
      }
    }
    pose[0] = place * pose[0];
    local_to_world(clip.skeleton.parents, pose, pose);
    clip.set_pose(static_cast<int>(f), pose);
  }
  return clip;
}

// A motion on charts, kept with what it points to.
struct Shown {
  explicit Shown(Clip moving, std::string name = "a.bvh")
      : clip(std::move(moving)), roles(find_roles(clip.skeleton)) {
    charted.name = std::move(name);
    charted.clip = &clip;
    charted.roles = &roles;
    charted.frames = {0, clip.frame_count() - 1};
  }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;
  double angle(BodyAngle which, Side side) const {
    const auto values = body_angle(clip, roles, which, side, charted.frames);
    return values.empty() ? -999 : values[0];
  }

  Clip clip;
  RoleMap roles;
  ChartedMotion charted;
};

// A figure that slides sideways and ahead at a constant speed while its left leg is lifted.
inline Clip sliding() {
  std::vector<Turns> poses(11);
  Clip clip = posed(poses);
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (Vec3f& place : clip.frame_positions(f)) {
      place += Vec3f(0.03f, 0, 0.04f) * static_cast<float>(f);
    }
    const auto within = static_cast<std::size_t>(clip.skeleton.find("LeftFoot"));
    for (std::size_t j = within; j < within + 3; ++j) {
      clip.frame_positions(f)[j].y() += 0.01f * static_cast<float>(f * f);
    }
  }
  return clip;
}

}  // namespace krok::draw
