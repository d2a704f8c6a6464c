#pragma once

#include <vector>

#include "gait/foot_paths_internal.h"

// The frames of a part of a walk. Each part is computed by itself, from its own and neighbouring
// steps, so that the walk does not depend on how it is divided. Used by walk().

namespace krok::gait {

// What all parts of a walk have in common.
struct WalkParts {
  const Walker& walker;
  const PlannedWalk& plan;
  const BodyMotion& body;
  const Terrain& ground;
  const WalkOptions& options;
  double rate = 30;
  int frames = 0;  // of the walk

  double time_of(int frame) const { return frame / rate; }
  // The first frame of a step; that of the step after the last is the number of frames.
  int first_frame(std::size_t step) const;
  FootSide side_of(std::size_t print) const { return plan.grounded[print].side; }
  const Leg& leg_of(std::size_t print) const { return walker.leg(side_of(print)); }
};

// Measures of a step, taken while its frames are made.
struct MadeStep {
  double clearance = 0, lowered = 0, extension = 0, missed = 0;
  double off_support = 0;  // metres, of the hips, level
  double ankle = 0;        // radians by which an ankle bends more than in standing, toes up
};

class WalkBlock {
 public:
  WalkBlock(const WalkParts& parts, std::size_t first_step, std::size_t end_step);

  // Makes the frames of the steps [first, end): joint_to_world of all joints, frame by frame, into
  // `clip`, whose first frame is that of the first step. `steps`: of the walk.
  void make(Clip& clip, std::span<MadeStep> steps);

  // A print's times; of prints that the block's steps stand on or step to.
  const Stance& stance(std::size_t print) const { return stances_[print - low_]; }

 private:
  SampledStep sample(std::size_t step) const;
  FootPose blend_foot(std::size_t step, double time, FootSide side, const Quat& signs) const;
  const FootPose& nearest(std::size_t step, double time, FootSide side) const;
  const Gap* gap_after(std::size_t step) const;
  SampledStep& sampled(std::size_t step) { return sampled_[step - low_]; }
  const SampledStep& sampled(std::size_t step) const { return sampled_[step - low_]; }
  Stance& changed_stance(std::size_t print) { return stances_[print - low_]; }
  double& need(int frame) {
    return needs_[static_cast<std::size_t>(frame - parts_.first_frame(low_))];
  }

  void begin_stance(std::size_t print);
  void finish_stance(std::size_t print);
  void roll_over_ball(std::size_t print);
  void place_feet(std::size_t step, MadeStep& made);
  Swing make_swing(std::size_t step) const;
  void emit(std::size_t step, Clip& clip, MadeStep& made);

  const WalkParts& parts_;
  std::size_t first_, end_;  // steps that are made
  std::size_t low_, high_;   // steps that are looked at
  std::vector<Gap> gaps_;    // from step low - 1 on
  std::vector<SampledStep> sampled_;
  std::vector<Stance> stances_;
  std::vector<double> needs_;    // [frames], metres that the pelvis must be lowered
  std::vector<double> lowered_;  // [frames], metres that it is
};

// Contacts and keytimes of a walk; fills the times of its prints.
MotionKeys keys_of(const WalkParts& parts, std::span<const Stance> stances, double duration,
                   std::span<GroundedPrint> prints);

}  // namespace krok::gait
