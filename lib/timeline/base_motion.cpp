#include "timeline/base_motion.h"

#include <algorithm>

namespace krok::timeline {

BaseMotion::BaseMotion(const Timeline& timeline, std::span<const Source> sources,
                       const RoleMap& roles, std::vector<ScheduledItem> items, double rate)
    : carrier_(carrying_joint(roles)), items_(std::move(items)) {
  const auto source_of = [&](std::size_t i) -> const Source& {
    return sources[static_cast<std::size_t>(items_[i].range.source)];
  };
  players_.reserve(items_.size());  // transitions keep references to them
  skeleton_ = &source_of(0).clip->skeleton;
  transitions_.resize(items_.size());
  on_feet_.resize(items_.size(), 0);
  for (std::size_t i = 0; i < items_.size(); ++i) {
    players_.emplace_back(source_of(i), items_[i].range, carrier_,
                          items_[i].play_time(items_[i].end));
    const BaseItem& entry = timeline.base[i];
    if (i == 0) {
      if (entry.place) players_[0].put(0, *entry.place);
      continue;
    }
    bool on_feet = false;
    transitions_[i] = make_transition(
        {players_[i - 1], players_[i], items_[i - 1], items_[i], entry.change, entry.place, rate},
        on_feet);
    on_feet_[i] = on_feet ? 1 : 0;
  }
}

std::size_t BaseMotion::item_at(double time) const {
  const auto after = std::ranges::upper_bound(items_, time, {}, &ScheduledItem::begin);
  return after == items_.begin() ? 0 : static_cast<std::size_t>(after - items_.begin()) - 1;
}

void BaseMotion::pose(double time, std::span<Transform> joint_to_world) const {
  const std::size_t i = item_at(time);
  if (transitions_[i] != nullptr && time < items_[i].settled) {
    to_world(*skeleton_, transitions_[i]->at(time), joint_to_world);
    return;
  }
  players_[i].pose(items_[i].play_time(time), joint_to_world);
}

BaseMotion::Untouched BaseMotion::untouched(double time) const {
  const std::size_t i = item_at(time);
  if (transitions_[i] != nullptr && time < items_[i].settled) return {};
  const int frame = players_[i].untouched_frame(items_[i].play_time(time));
  if (frame < 0) return {};
  return {players_[i].source().clip, frame};
}

}  // namespace krok::timeline
