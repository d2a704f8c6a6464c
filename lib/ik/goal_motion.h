#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "core/result.h"
#include "ik/solver.h"
#include "scene/clip.h"
#include "scene/frame_source.h"
#include "timeline/easing.h"

// Goals over time, brought about in every frame of a motion.

namespace krok::ik {

struct GoalKey {
  double time = 0;  // seconds
  Vec3 target = Vec3::Zero();
  Quat orientation = Quat::Identity();
  timeline::Easing easing;  // to the next key
};

// A goal that moves through keys and fades in and out, so that it takes hold and lets go without a
// jump. While it fades, a position or pose is sought where the joint comes to lie once the turns
// that the goal alone needs are made in part (an arm that straightens for a place out of reach does
// so as evenly as the fade), for a place in the world that meanwhile goes along with the body in
// part; of the other kinds the target lies between what the motion does by
// itself and the keys.
struct KeyedGoal {
  std::string name;  // for reports

  // What is sought; target and orientation come from the keys.
  Goal goal;

  // The keys are in the frame of this joint: of `motion` where that is set, otherwise of the motion
  // itself as it comes out. -1: in the world.
  int relative_to = -1;
  const Clip* motion = nullptr;

  // Times increase, at least one key (balance needs none). Before the first key its values hold,
  // after the last one the last one's.
  std::vector<GoalKey> keys;

  // Seconds: full strength from `from` to `to`, fading in before and out after. Absent: from the
  // first key's time, to the last one's; for a goal without keys the whole motion.
  std::optional<double> from, to;
  double fade_in = 0.3, fade_out = 0.3;
  timeline::Easing fade = {timeline::Curve::smoother, timeline::Ease::in_out};

  // For balance: the support is the outline on the ground of these joints as they stand in each
  // frame of the input.
  std::vector<int> support_joints;
};

struct GoalFrame {
  int frame = 0;
  double strength = 0;  // 0 to 1
  Residual residual;    // from the target of that frame
};

struct GoalMotion {
  Clip clip;
  std::vector<std::vector<GoalFrame>> goals;  // [goals], the frames in which each is active
  int changed_frames = 0;
  double largest_excess = 0;  // of limits, radians, by joints in chains at full strength
  // The largest turn of a joint relative to its parent from a frame to the next, of those that
  // goals change: radians, the joint (-1: none), the later frame; and what the largest is in the
  // input.
  double largest_turn = 0, input_turn = 0;
  int turning_joint = -1, turning_frame = -1;
  // How far goals move each joint at most, metres, and in which frame (-1: never). [joints]
  struct Shift {
    double distance = 0;
    int frame = -1;
  };
  std::vector<Shift> shifts;
  // How much further than the motion goals bring each joint beyond the ranges of the options,
  // radians, and in which frame (-1: never). [joints]; empty without ranges.
  struct Excess {
    double angle = 0;
    int frame = -1;
  };
  std::vector<Excess> excesses;
};

inline constexpr double kHeldWeight = 4;

struct HeldFoot {
  // Joints of the leg; without the upper one (-1) the foot is held by whatever carries it.
  int upper = 0, lower = 0, foot = 0;
  Vec3 knee_axis = Vec3::UnitX();  // cross(thigh, shank) as it bends, in the upper joint's frame
};

struct GoalMotionOptions {
  Options solver;
  // Joints that keep their orientation in the world, but for their limits, where their own goals do
  // not turn them: a head looks where it looked as the trunk leans.
  std::vector<int> upright;
  // Feet that keep their place and orientation in the world where goals turn or shift what carries
  // them. They count kHeldWeight times as much as goals do; knees bend as they did, and about their
  // usual axis where they are bent further.
  std::vector<HeldFoot> held;
  Limits ranges;                 // of motion, to be measured, not kept; empty: none
  int jobs = 0;                  // for stretches of frames without goals between them
  Progress* progress = nullptr;  // may be null
};

// The motion with the goals brought about as well as they can be. Each frame is solved from the
// frame as it was, plus what the goals changed in the frame before, so that nothing spins or flips
// where they leave a choice or are out of reach. Of that change a quarter of a second forgets 1 -
// 1/e: what goals leave open goes back to as captured, and nothing builds up over time. Frames in
// which no goal is active stay bit for bit. A joint that the motion itself holds beyond
// its limits is brought within them as the goals fade in.
//
// Codes: ik-goal for a goal that Solver refuses, keys whose times do not increase, no keys; those
// of Solver::create.
Result<GoalMotion> apply_goals(const Clip& clip, std::span<const KeyedGoal> goals,
                               const Limits& limits, const GoalMotionOptions& options = {});

struct GoalFrames {
  FrameSource frames;                  // to be read about in order
  std::shared_ptr<GoalMotion> motion;  // complete, but for its clip, once all frames were read
};

// The same of frames generated on demand, in blocks, in memory that hardly grows with their number
// (40 bytes for each goal that is active in a frame): the result does not depend on `block_frames`.
// The goals must outlive the result.
Result<GoalFrames> apply_goals(const FrameSource& source, std::span<const KeyedGoal> goals,
                               const Limits& limits, const GoalMotionOptions& options,
                               int block_frames = 4096);

// A goal as it stands in a frame of a motion, whatever its strength: target and orientation in the
// world, the support where its joints stand. The goal is one that apply_goals() takes.
Goal goal_in_frame(const KeyedGoal& goal, const Clip& clip, int frame);

// Strength of a goal at the time of a frame, 0 to 1, for a motion that lasts `duration` seconds at
// `rate` frames per second. A goal that would have its full strength between two frames has it in
// the nearer one.
double strength_at(const KeyedGoal& goal, double time, double duration, double rate);

// Target and orientation of the keys at a time.
GoalKey key_at(const KeyedGoal& goal, double time);

// The convex outline of points on the ground, counter-clockwise (Andrew's monotone chain).
std::vector<Vec2> outline(std::vector<Vec2> points);

}  // namespace krok::ik
