#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "draw/joint_angles.h"
#include "draw/plot.h"
#include "math/euler.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// Charts of motions: panels for a Figure. Several motions go into the same panels. Left and right
// have a colour each, the same in all panels, and motions a stroke pattern each, so that
// motion_legend tells all; lines that are neither left nor right take a motion's own colour.

namespace krok::draw {

struct ChartedMotion {
  std::string name;  // for legends
  const Clip* clip = nullptr;
  const RoleMap* roles = nullptr;
  FrameRange frames;  // shown; times stay those of the clip
  // Contacts of feet are drawn as bars below the panels about legs, one lane a side and motion;
  // keytimes as lines across, with their names over the heights of the feet.
  MotionKeys keys;
};

// What colours and patterns stand for: left and right if `sides`, the motions if there are several.
std::vector<LegendEntry> motion_legend(std::span<const ChartedMotion> motions, bool sides);

// The way of the hips (of the root where no role tells of hips) from above, +Z to the right and +X,
// the left of a figure that faces +Z, upwards. An arrow ends it; dots mark even steps in time, told
// in the title. Places of contacts of feet are points in their side's colour.
std::vector<Panel> path_panels(std::span<const ChartedMotion> motions);

// Heights (metres over y = 0) of the lowest joint of each foot and speeds (metres a second) of its
// slowest one, so that a foot that stands or rolls shows as one at rest. Speeds are central
// differences, at a clip's ends one-sided. No panels where no motion has feet; no speeds of clips
// of one frame.
std::vector<Panel> foot_panels(std::span<const ChartedMotion> motions, Scale speed_scale);

// Hips, knees, ankles, shoulders, elbows: see body_angle. A panel for each that any motion has.
std::vector<Panel> body_angle_panels(std::span<const ChartedMotion> motions);

// World positions of joints (metres). Of one motion a panel a joint; of several one for each joint
// and axis, with a line for each motion that has a joint of that name.
std::vector<Panel> position_panels(std::span<const ChartedMotion> motions,
                                   std::span<const std::string> joints);

// How far joints are turned from the reference pose: see turn_angle. Of one motion all in one
// panel.
std::vector<Panel> turn_panels(std::span<const ChartedMotion> motions,
                               std::span<const std::string> joints);

// The same as Euler angles: see euler_angles. Panels as in position_panels.
std::vector<Panel> euler_panels(std::span<const ChartedMotion> motions,
                                std::span<const std::string> joints, const EulerOrder& order);

// The names of the joints that turn most in the frames shown, `count` of them at most, in the
// skeleton's order; end sites and joints that do not turn are left out.
std::vector<std::string> most_turning_joints(const ChartedMotion& motion, int count);

}  // namespace krok::draw
