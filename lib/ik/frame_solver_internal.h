#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ik/goal_motion.h"
#include "ik/solver.h"
#include "scene/clip.h"
#include "scene/frame_source.h"

namespace krok::ik {

// Of the frame before, for each goal: what it turned in the joints' frames, all of them together,
// or, as it fades, what it alone turns at full strength.
struct TurnsBefore {
  std::vector<std::vector<Vec3>> turns;  // [goals][joints]
  std::vector<double> strengths;         // [goals]
};

// The joint that carries the body, Options::moving_joint, in world space, in the first and the last
// frame of a goal's full strength; empty for goals that are not in the world.
using CarriedFrom = std::optional<std::array<Transform, 2>>;

// Solves one frame after the other; one for each thread. `run` is of a take that lasts `duration`
// seconds; its frames are numbered as in the take.
class FrameSolver {
 public:
  FrameSolver(const FrameRun& run, double duration, std::span<const KeyedGoal> goals,
              std::span<const CarriedFrom> carried, const GoalMotionOptions& options, Solver solver,
              TurnsBefore before)
      : clip_(run.clip),
        first_(run.first),
        duration_(duration),
        goals_(goals),
        carried_(carried),
        options_(options),
        solver_(std::move(solver)),
        turns_(std::move(before.turns)),
        strengths_before_(std::move(before.strengths)) {
    const Clip& clip = run.clip;
    const std::size_t joints = clip.skeleton.names.size();
    given_.resize(joints);
    solved_.resize(joints);
    for (const KeyedGoal& goal : goals) {
      if (goal.motion) {
        other_.resize(std::max(other_.size(), goal.motion->skeleton.names.size()));
      }
    }
    scratch_.resize(3 * other_.size());
  }

  Status solve(int frame, std::span<GoalFrame> report, Clip& result, double& excess);
  TurnsBefore before() && { return {std::move(turns_), std::move(strengths_before_)}; }

 private:
  Transform anchor(const KeyedGoal& goal, double time);
  Status list_goals(double time);
  bool fades_by_turns(std::size_t g) const;
  void carry_along(std::size_t g, double time, Goal& goal) const;
  Status fade_by_turns(std::size_t g, bool first, Goal& goal);
  void turn_given(const std::vector<Vec3>& turns, double part);
  void list_turns(std::vector<Vec3>& turns);
  void mark_chains();
  void hold();
  void bend_legs();
  void turn_to(int joint, const Quat& orientation);
  void start_from_before();
  void start_limbs();
  void keep_upright();
  bool blend_in(double strength);
  double excess_of_chains() const;

  const Clip& clip_;
  int first_;  // number of its first frame
  double duration_;
  std::span<const KeyedGoal> goals_;
  std::span<const CarriedFrom> carried_;
  const GoalMotionOptions& options_;
  Solver solver_;
  std::vector<Transform> given_, solved_, other_, scratch_, local_, before_solving_;
  std::vector<Goal> active_;
  std::vector<double> strengths_;
  std::vector<const HeldFoot*> held_;             // in this frame
  std::vector<std::uint8_t> in_chain_;            // [joints], of the frame's goals
  std::vector<std::vector<Vec3>> turns_;          // see TurnsBefore
  std::vector<double> strengths_before_, parts_;  // how much of the turns is in the start
  std::vector<Vec3> mean_;
};

}  // namespace krok::ik
