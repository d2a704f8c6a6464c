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
