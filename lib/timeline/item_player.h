#pragma once

#include <span>
#include <vector>

#include "timeline/actor_pose.h"
#include "timeline/played_range.h"
#include "timeline/timeline.h"

namespace krok::timeline {

// Samples the poses of an item. Each loop continues from where the previous one left the character.
// Const members are safe to call from several threads.
class ItemPlayer {
 public:
  // `longest`: the largest play time that will be sampled.
  ItemPlayer(const Source& source, const PlayedRange& range, int carrier, double longest);

  const PlayedRange& range() const { return range_; }
  const Source& source() const { return *source_; }

  // Places the whole motion; the identity initially.
  void set_place(const GroundFrame& motion_to_world) { motion_to_world_ = motion_to_world; }
  // Places the motion so that its ground frame at a play time is `place`.
  void put(double play_time, const GroundFrame& place);

  // motion_to_world in a loop round.
  GroundFrame round_place(int round) const;

  // joint_to_world at a play time.
  void pose(double play_time, std::span<Transform> joint_to_world) const;
  ActorPose actor(double play_time) const;

  // The source frame that equals the pose at a play time bit for bit; -1 if there is none.
  int untouched_frame(double play_time) const;

  // Whether a joint is in contact at a play time, according to the motion's contacts.
  bool stands(int joint, double play_time) const;
  // The same as a weight: 1 within a contact, falling smoothly to 0 at its beginning and end, which
  // lets feet take the figure over from each other without a jerk. Contacts that the ends of the
  // motion cut off do not fall there.
  double contact_weight(int joint, double play_time) const;

 private:
  const Source* source_;
  PlayedRange range_;
  int carrier_;
  GroundFrame motion_to_world_;
  // Root motion over 1, 2, 4, ... rounds.
  std::vector<GroundFrame> steps_;
};

}  // namespace krok::timeline
