#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "gait/legs_internal.h"

// The frames of a walk, step by step: as few steps as needed are held at a time. Used by walk().

namespace krok::gait {

class WalkMaker {
 public:
  WalkMaker(const Walker& walker, const PlannedWalk& plan, const BodyMotion& body,
            const Terrain& ground, const WalkOptions& options, double rate);

  // Makes all frames of the walk, on the walker's skeleton, and what `walk` says of its steps.
  void make(Walk& walk, Progress* progress);

 private:
  SampledStep sample(std::size_t step) const;
  FootPose blend_foot(std::size_t step, double time, FootSide side, const Quat& signs) const;
  const FootPose& nearest(const SampledStep& step, double time, FootSide side) const;
  void begin_stance(std::size_t print);
  void finish_stance(std::size_t print);
  void place_feet(std::size_t step);
  Swing make_swing(std::size_t step);
  void emit(std::size_t step, Walk& walk);
  void add_keys(Walk& walk) const;

  double time_of(int frame) const { return frame / rate_; }
  FootSide side_of(std::size_t print) const { return plan_.grounded[print].side; }
  const Leg& leg_of(std::size_t print) const { return walker_.leg(side_of(print)); }

  const Walker& walker_;
  const PlannedWalk& plan_;
  const BodyMotion& body_;
  const Terrain& ground_;
  const WalkOptions& options_;
  double rate_;
  int frames_ = 0;
  std::vector<SampledStep> sampled_;  // [steps], emptied when emitted
  std::vector<Stance> stances_;       // [prints]
  std::vector<double> needs_;         // [frames], metres that the pelvis must be lowered
  std::vector<double> clearances_;    // [steps]
};

}  // namespace krok::gait
