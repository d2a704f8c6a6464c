#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "motion/hips_root.h"
#include "roles/roles.h"
#include "scene/skeleton.h"
#include "timeline/played_range.h"
#include "timeline/schedule.h"
#include "timeline/timeline.h"

// A pose split into the actor's ground frame (position and heading) and joints relative to it.

namespace krok::timeline {

struct ActorPose {
  GroundFrame place;
  std::vector<Transform> local;  // joint_to_parent; the root is relative to the ground frame
};

ActorPose actor_pose(const Skeleton& skeleton, int carrier,
                     std::span<const Transform> joint_to_world);
void to_world(const Skeleton& skeleton, const ActorPose& pose, std::span<Transform> joint_to_world);

// Composition and inverse as 2D transforms: `second` is given in the frame of `first`.
GroundFrame combined(const GroundFrame& first, const GroundFrame& second);
GroundFrame inverse(const GroundFrame& place);

// x, z, heading. difference() wraps the heading to half a turn.
Vec3 as_vector(const GroundFrame& place);
Vec3 difference(const GroundFrame& from, const GroundFrame& to);
GroundFrame moved(const GroundFrame& place, const Vec3& by);

// Samples the poses of an item. Each loop continues from where the previous one left the character.
// Const members are safe to call from several threads.
class ItemPlayer {
 public:
  // `longest`: the largest play time that will be sampled.
  ItemPlayer(const Source& source, const PlayedRange& range, int carrier, double longest);

  const PlayedRange& range() const { return range_; }
  const Source& source() const { return *source_; }

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

// A prepared transition from one item to the next.
class Transition {
 public:
  virtual ~Transition() = default;
  // The pose at a result time within the transition.
  virtual ActorPose at(double time) const = 0;
};

// The two items of a transition. The transition positions the next item's player.
struct TransitionSides {
  const ItemPlayer& previous;
  ItemPlayer& next;
  const ScheduledItem& previous_times;
  const ScheduledItem& next_times;
  const Change& change;
  std::optional<GroundFrame> place;  // the ground frame requested for the next item
  double rate;                       // of the result
};

// Null for a cut, which only positions the next item. Sets `on_feet` if feet in contact in both
// motions were found and kept planted.
std::unique_ptr<Transition> make_transition(const TransitionSides& sides, bool& on_feet);

// The base items in sequence: full-body motion including the root.
class BaseMotion {
 public:
  // `items` are those of schedule().
  BaseMotion(const Timeline& timeline, std::span<const Source> sources, const RoleMap& roles,
             std::vector<ScheduledItem> items, double rate);

  const std::vector<ScheduledItem>& items() const { return items_; }
  const ItemPlayer& player(std::size_t item) const { return players_[item]; }
  bool on_feet(std::size_t item) const { return on_feet_[item] != 0; }
  int carrier() const { return carrier_; }

  // The item played at a time; from the start of a transition on, the next item.
  std::size_t item_at(double time) const;

  // joint_to_world at a result time.
  void pose(double time, std::span<Transform> joint_to_world) const;

  // The source frame that equals the pose at a time bit for bit.
  struct Untouched {
    const Clip* clip = nullptr;  // null if there is none
    int frame = -1;
  };
  Untouched untouched(double time) const;

 private:
  int carrier_;
  const Skeleton* skeleton_;
  std::vector<ScheduledItem> items_;
  std::vector<ItemPlayer> players_;
  std::vector<std::unique_ptr<Transition>> transitions_;  // [items], null if there is none
  std::vector<std::uint8_t> on_feet_;
};

}  // namespace krok::timeline
