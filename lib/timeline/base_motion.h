#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "roles/roles.h"
#include "timeline/item_player.h"
#include "timeline/schedule.h"
#include "timeline/timeline.h"

namespace krok::timeline {

// How one item goes over into the next, worked out.
class Transition {
 public:
  virtual ~Transition() = default;
  // The figure at a moment of the result within the transition.
  virtual ActorPose at(double time) const = 0;
};

// The two items that a transition lies between. The next one's player is put in its place by the
// transition.
struct TransitionSides {
  const ItemPlayer& previous;
  ItemPlayer& next;
  const ScheduledItem& previous_times;
  const ScheduledItem& next_times;
  const Change& change;
  std::optional<GroundFrame> place;  // where the next one is told to stand
  double rate;                       // of the result
};

// None for a cut, which only puts the next one in its place. `on_feet` is set where feet that stand
// in both were found and followed.
std::unique_ptr<Transition> make_transition(const TransitionSides& sides, bool& on_feet);

// The items of the base one after the other: what moves the whole figure.
class BaseMotion {
 public:
  // `items` are those of schedule().
  BaseMotion(const Timeline& timeline, std::span<const Source> sources, const RoleMap& roles,
             std::vector<ScheduledItem> items, double rate);

  const std::vector<ScheduledItem>& items() const { return items_; }
  const ItemPlayer& player(std::size_t item) const { return players_[item]; }
  bool on_feet(std::size_t item) const { return on_feet_[item] != 0; }
  int carrier() const { return carrier_; }

  // The item that is played at a moment, the one that is changed into included.
  std::size_t item_at(double time) const;

  // joint_to_world at a moment.
  void pose(double time, std::span<Transform> joint_to_world) const;

  // The frame of a motion that is the pose at a moment, bit for bit.
  struct Untouched {
    const Clip* clip = nullptr;  // null where there is none
    int frame = -1;
  };
  Untouched untouched(double time) const;

 private:
  int carrier_;
  const Skeleton* skeleton_;
  std::vector<ScheduledItem> items_;
  std::vector<ItemPlayer> players_;
  std::vector<std::unique_ptr<Transition>> transitions_;  // [items], null where there is none
  std::vector<std::uint8_t> on_feet_;
};

}  // namespace krok::timeline
