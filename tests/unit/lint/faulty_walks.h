#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "core/index.h"
#include "lint/lint.h"
#include "math/quaternion.h"
#include "motion/local_motion.h"
#include "samples/generator/walk.h"

// Generated walks with a fault put into them, and what lint finds there.

namespace krok::lint_test {

using lint::Rule;
using samples::WalkOptions;

inline Clip walk_of(WalkOptions options) {
  auto made = samples::make_walk(options);
  EXPECT_TRUE(made.ok());
  return std::move(made->clip);
}

inline Clip usual_walk(double rate = 60) {
  WalkOptions options;
  options.steps = 10;
  options.rate = rate;
  // As much as optical captures have: a motion without any noise is none.
  options.noise_angle = 0.05 * kRadiansPerDegree;
  return walk_of(options);
}

inline lint::MotionFaults faults_of(const Clip& clip, const lint::MotionOptions& options = {}) {
  return lint::lint_motion(clip, find_roles(clip.skeleton), options);
}

inline std::string listed(const Clip& clip, const lint::MotionFaults& faults) {
  std::string text;
  for (const lint::Finding& f : faults.findings) {
    text += std::string(facts_of(f.rule).id) + " " + f.kind + " " +
            (f.joint >= 0 ? clip.skeleton.names[at(f.joint)] : "body") + " at " +
            std::to_string(f.worst) + ": " + std::to_string(f.value) + "\n";
  }
  return text;
}

inline const lint::Finding* find(const lint::MotionFaults& faults, Rule rule, int frame) {
  for (const lint::Finding& finding : faults.findings) {
    if (finding.rule == rule && finding.first - 2 <= frame && frame <= finding.last + 2) {
      return &finding;
    }
  }
  return nullptr;
}

using Change = std::function<void(LocalMotion&, Clip&)>;

inline Clip changed(const Clip& clip, const Change& change) {
  LocalMotion local = local_motion(clip);
  Clip result = clip;
  change(local, result);
  set_local_motion(local, result);
  return result;
}

inline constexpr int kAt = 150;  // frame, of a walk at 60 frames a second

inline Quat turn(double degrees) {
  return from_rotation_vector(Vec3(0.6, 0.0, 0.8) * degrees * kRadiansPerDegree);
}

// A walker who stands on the right foot, the left one lifted, and is moved as a whole: `place` of
// each second, metres and radians about the vertical through `pivot` metres ahead of the ankle.
inline Clip stander(double pivot,
                    const std::function<std::pair<Vec3, double>(double seconds)>& place) {
  Clip clip = changed(usual_walk(), [](LocalMotion& m, Clip& c) {
    for (int j = 0; j < m.joints; ++j) {
      std::ranges::fill(m.joint_orientations(j), m.joint_orientations(j)[0]);
    }
    std::ranges::fill(m.joint_positions(0), m.joint_positions(0)[0]);
    for (Quat& leg : m.joint_orientations(c.skeleton.find("LeftUpLeg"))) leg = leg * turn(60);
  });
  const Vec3f ankle = clip.positions[at(clip.skeleton.find("RightFoot"))];
  const Vec3f toes = clip.positions[at(clip.skeleton.find("RightToeBase"))];
  Vec3f ahead = toes - ankle;
  ahead.y() = 0;
  const Vec3f centre = ankle + static_cast<float>(pivot) * ahead.normalized();
  for (int f = 0; f < clip.frame_count(); ++f) {
    const auto [moved, angle] = place(f / clip.rate);
    const Quatf turned = from_rotation_vector(Vec3(0, angle, 0)).cast<float>();
    for (Vec3f& joint : clip.frame_positions(f)) {
      joint = centre + turned * (joint - centre) + moved.cast<float>();
    }
    for (Quatf& joint : clip.frame_orientations(f)) joint = turned * joint;
  }
  return clip;
}

}  // namespace krok::lint_test
