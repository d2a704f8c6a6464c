#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "draw/joint_angles.h"
#include "draw/plot.h"
#include "draw/viewer_page.h"
#include "math/quaternion.h"
#include "math/transform.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// Charts of motions: panels for a Chart. Several motions share the same panels. Each side has its
// own colour in all panels, and each motion its own dash pattern; lines that are neither left nor
// right take the colour of their motion. motion_legend covers every panel.

namespace krok::draw {

struct ChartedMotion {
  std::string name;  // shown in legends
  const Clip* clip = nullptr;
  const RoleMap* roles = nullptr;
  FrameRange frames;  // frames to show; times stay those of the clip
  // Foot contacts are drawn as bars below the leg panels, one lane per side and motion; keytimes as
  // vertical lines, labelled in the foot height panel.
  MotionKeys keys;
};

// The ground that the motions are on, and the footprints on it.
struct ChartedGround {
  // The height of the ground below a point, or just above it (a foot that sinks in), in metres;
  // empty where there is none. Without a function: a level ground at 0.
  std::function<std::optional<double>(const Vec3&)> height;
  std::function<Vec3(const Vec3&)> up;  // which way it faces there, a unit vector
  std::vector<ViewedPrint> prints;
};

// An entry for each kind of line in the panels that have no legend of their own, with the line's
// own colour and dash pattern: left and right of each motion, and the motions themselves where
// lines are neither. For one motion, whose name the chart gives, left and right alone.
std::vector<LegendEntry> motion_legend(std::span<const ChartedMotion> motions,
                                       std::span<const Panel> panels);

// Top view of the path of the hips (of the root if no joint has the hips role), with +Z to the
// right and +X, the left of a character that faces +Z, upwards. The path ends in an arrow; dots
// mark equal time steps, given in the title. Foot contact positions are points in the colour of
// their side. With a ground: its height as colours and contour lines where it is not level, the
// footprints as numbered soles, and the ways of the feet.
std::vector<Panel> path_panels(std::span<const ChartedMotion> motions,
                               const ChartedGround& ground = {});

// Heights (metres above y = 0) of the lowest joint of each foot and speeds (metres per second) of
// its slowest joint, so that a planted or rolling foot has a speed near zero. Speeds are central
// differences, one-sided at the ends of a clip. No panels if no motion has feet; no speeds for
// clips of one frame. With a ground, heights are over it, of the lowest sole point (heel, ball,
// tip) where the foot has some.
std::vector<Panel> foot_panels(std::span<const ChartedMotion> motions, Scale speed_scale,
                               const ChartedGround& ground = {});

// Hips, knees, ankles, shoulders, elbows: see body_angle. One panel for each that any motion has.
std::vector<Panel> body_angle_panels(std::span<const ChartedMotion> motions);

// The same angles over the gait cycle of their side, from strike to strike in percent: the mean of
// all whole cycles (gait_cycles()) of all motions within the frames shown, and a band of one
// standard deviation (of the sample; none for a single cycle) about it. A line marks the mean
// toe-off.
struct CycleCharts {
  std::vector<Panel> panels;    // none without a cycle
  std::array<int, 2> counts{};  // cycles of the left and right side
  int runs = 0;                 // of both, with the foot on the ground for less than half of it
  int motions = 0;              // that have a cycle
  int max_cycles = 0;           // of one motion
  int max_cycles_of = -1;       // its index
};
CycleCharts cycle_charts(std::span<const ChartedMotion> motions);

// World positions of joints (metres). For one motion, a panel per joint; for several, a panel per
// joint and axis with a line for each motion that has a joint of that name.
std::vector<Panel> position_panels(std::span<const ChartedMotion> motions,
                                   std::span<const std::string> joints);

// Rotation angles of joints from the reference pose: see turn_angle. For one motion, all in one
// panel.
std::vector<Panel> turn_panels(std::span<const ChartedMotion> motions,
                               std::span<const std::string> joints);

// The same rotations as Euler angles: see euler_angles. Panels as in position_panels.
std::vector<Panel> euler_panels(std::span<const ChartedMotion> motions,
                                std::span<const std::string> joints, const EulerOrder& order);

// The names of at most `count` joints that rotate most in the frames shown, in skeleton order; end
// sites and joints that do not rotate are left out.
std::vector<std::string> most_turning_joints(const ChartedMotion& motion, int count);

// The outline of a left sole, seen from above, in parts of its length: x to the left, y ahead, from
// the heel at (0, 0) to the tip at 1; closed. A right one is its mirror image.
std::vector<Vec2> sole_outline();

}  // namespace krok::draw
