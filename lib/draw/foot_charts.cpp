#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "contacts/sole_points.h"
#include "draw/chart_style_internal.h"
#include "draw/motion_charts.h"
#include "motion/hips_root.h"

namespace krok::draw {

namespace {

// The ankle and all joints beyond it.
std::vector<int> joints_of_foot(const ChartedMotion& motion, Side side) {
  std::vector<int> joints;
  const int ankle = motion.roles->joint(side == Side::left ? Role::left_foot : Role::right_foot);
  if (ankle < 0) return joints;
  const auto within = subtree(motion.clip->skeleton, ankle);
  for (std::size_t j = 0; j < within.size(); ++j) {
    if (within[j] != 0) joints.push_back(static_cast<int>(j));
  }
  return joints;
}

std::vector<double> lowest_heights(const ChartedMotion& motion, const std::vector<int>& joints) {
  std::vector<double> heights;
  for (int f = motion.frames.first; f <= motion.frames.last; ++f) {
    const auto positions = motion.clip->frame_positions(f);
    double lowest = std::numeric_limits<double>::infinity();
    for (const int joint : joints) {
      lowest = std::min<double>(lowest, positions[static_cast<std::size_t>(joint)].y());
    }
    heights.push_back(lowest);
  }
  return heights;
}

// Over the ground, of the lowest of the sole points or, without any, of the joints; NaN where there
// is no ground.
std::vector<double> heights_over(const ChartedGround& ground, const ChartedMotion& motion,
                                 Side side, const std::vector<int>& joints) {
  const Feet feet = find_feet(*motion.clip, *motion.roles, ground.up);
  std::vector<SolePoint> points = feet.points[side == Side::left ? 0 : 1];
  for (const int joint : joints) {
    if (feet.points[side == Side::left ? 0 : 1].empty()) points.emplace_back().joint = joint;
  }
  std::vector<double> heights;
  for (int f = motion.frames.first; f <= motion.frames.last; ++f) {
    double lowest = std::numeric_limits<double>::quiet_NaN();
    for (const SolePoint& point : points) {
      const auto j = static_cast<std::size_t>(point.joint);
      const Vec3 at = motion.clip->frame_positions(f)[j].cast<double>() +
                      motion.clip->frame_orientations(f)[j].cast<double>() * point.offset;
      const auto below = ground.height(at);
      if (below) lowest = std::fmin(lowest, at.y() - *below);
    }
    heights.push_back(lowest);
  }
  return heights;
}

std::vector<double> slowest_speeds(const ChartedMotion& motion, const std::vector<int>& joints) {
  std::vector<double> speeds;
  const Clip& clip = *motion.clip;
  for (int f = motion.frames.first; f <= motion.frames.last; ++f) {
    const int before = std::max(f - 1, 0), after = std::min(f + 1, clip.frame_count() - 1);
    const auto from = clip.frame_positions(before), to = clip.frame_positions(after);
    double slowest = std::numeric_limits<double>::infinity();
    for (const int joint : joints) {
      const auto j = static_cast<std::size_t>(joint);
      slowest = std::min(slowest, (to[j] - from[j]).cast<double>().norm());
    }
    speeds.push_back(slowest * clip.rate / (after - before));
  }
  return speeds;
}

}  // namespace

std::vector<Panel> foot_panels(std::span<const ChartedMotion> motions, Scale speed_scale,
                               const ChartedGround& ground) {
  Panel heights = time_panel(
      motions,
      ground.height ? "Height of the soles over the ground" : "Height of the feet (lowest joint)",
      "height", "m");
  Panel speeds = time_panel(motions, "Speed of the feet (slowest joint)", "speed", "m/s");
  speeds.y.scale = speed_scale;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    for (const Side side : {Side::left, Side::right}) {
      const std::vector<int> joints = joints_of_foot(motions[m], side);
      if (joints.empty()) continue;
      heights.series.push_back(side_line(motions[m], m, side,
                                         ground.height
                                             ? heights_over(ground, motions[m], side, joints)
                                             : lowest_heights(motions[m], joints)));
      if (motions[m].clip->frame_count() < 2) continue;
      speeds.series.push_back(side_line(motions[m], m, side, slowest_speeds(motions[m], joints)));
    }
  }
  std::vector<Panel> panels;
  if (heights.series.empty()) return panels;
  add_keys(motions, true, heights);
  panels.push_back(std::move(heights));
  if (speeds.series.empty()) return panels;
  add_keys(motions, false, speeds);
  if (speed_scale == Scale::linear) speeds.y.low = 0;
  panels.push_back(std::move(speeds));
  return panels;
}

namespace {

constexpr int kPieces = 4;  // of the curve between two knots

// Round the sole, over its outer side to the toes and back.
constexpr std::array<std::array<double, 2>, 16> kKnots = {{{0, 0},
                                                           {0.09, 0.025},
                                                           {0.125, 0.12},
                                                           {0.12, 0.3},
                                                           {0.145, 0.5},
                                                           {0.175, 0.67},
                                                           {0.15, 0.83},
                                                           {0.06, 0.96},
                                                           {-0.05, 1},
                                                           {-0.13, 0.93},
                                                           {-0.16, 0.8},
                                                           {-0.155, 0.68},
                                                           {-0.105, 0.5},
                                                           {-0.085, 0.3},
                                                           {-0.11, 0.12},
                                                           {-0.085, 0.025}}};

}  // namespace

// Catmull and Rom's curve through the knots.
std::vector<Vec2> sole_outline() {
  const auto knot = [](std::size_t i) {
    const auto& [x, y] = kKnots[i % kKnots.size()];
    return Vec2(x, y);
  };
  std::vector<Vec2> outline;
  for (std::size_t i = 0; i < kKnots.size(); ++i) {
    const Vec2 a = knot(i + kKnots.size() - 1), b = knot(i), c = knot(i + 1), d = knot(i + 2);
    for (int k = 0; k < kPieces; ++k) {
      const double t = static_cast<double>(k) / kPieces;
      outline.push_back(0.5 * (2 * b + t * (c - a) + t * t * (2 * a - 5 * b + 4 * c - d) +
                               t * t * t * (3 * b - a - 3 * c + d)));
    }
  }
  return outline;
}

}  // namespace krok::draw
