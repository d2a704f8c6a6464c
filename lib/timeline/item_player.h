#pragma once

#include <span>
#include <vector>

#include "timeline/actor_pose.h"
#include "timeline/played_range.h"
#include "timeline/timeline.h"

namespace krok::timeline {

// Gives the poses of a played stretch of a motion. Each round goes on where the one before left the
// figure. Used from several threads at once.
class ItemPlayer {
 public:
  // `longest`: the play time up to which poses are asked for.
  ItemPlayer(const Source& source, const PlayedRange& range, int carrier, double longest);

  const PlayedRange& range() const { return range_; }
  const Source& source() const { return *source_; }

  // Where the motion as a whole is put; the identity at first.
  void set_place(const GroundFrame& motion_to_world) { motion_to_world_ = motion_to_world; }
  // Puts it so that the figure stands at `place` at a play time.
  void put(double play_time, const GroundFrame& place);

  // motion_to_world in a round.
  GroundFrame round_place(int round) const;

  // joint_to_world at a play time.
  void pose(double play_time, std::span<Transform> joint_to_world) const;
  ActorPose actor(double play_time) const;

  // The frame of the motion that is the pose at a play time, untouched; -1 where there is none.
  int untouched_frame(double play_time) const;

  // Whether a joint stands on something at a play time, by the motion's contacts.
  bool stands(int joint, double play_time) const;

 private:
  const Source* source_;
  PlayedRange range_;
  int carrier_;
  GroundFrame motion_to_world_;
  // From one round to the next, to the second next, to the fourth next, and so on.
  std::vector<GroundFrame> steps_;
};

}  // namespace krok::timeline
