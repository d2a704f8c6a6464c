#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "timeline/item_player.h"
#include "timeline/timeline.h"

namespace krok::timeline {

// When an item of a layer is seen.
struct LayerTimes {
  PlayedRange range;
  double start = 0, end = 0;
};

// Puts a layer's motions on poses. Used from several threads at once.
class LayerPlayer {
 public:
  // Codes timeline-mask, timeline-time, timeline-endless, timeline-weight and those of resolve(),
  // with the place of what is wrong. `end` is the base's: items last until then at most.
  static Result<LayerPlayer> create(const Layer& layer, std::span<const Source> sources,
                                    int carrier, double rate, double end);

  const std::vector<LayerTimes>& items() const { return items_; }

  // The weight of an item at a moment, fades included.
  double weight(std::size_t item, double time) const;
  bool is_seen(double time) const;

  // Joints that this layer moves, and those below them, [joints].
  const std::vector<std::uint8_t>& touched() const { return touched_; }

  // Changes the joints of the mask.
  void apply(double time, ActorPose& pose) const;

 private:
  void override_pose(const ActorPose& layer, double weight, ActorPose& pose) const;
  void override_in_model(const ActorPose& layer, double weight, ActorPose& pose) const;
  void add(const ActorPose& layer, const ActorPose& reference, double weight,
           ActorPose& pose) const;

  const Layer* layer_ = nullptr;
  const Skeleton* skeleton_ = nullptr;
  std::vector<double> mask_;
  std::vector<std::uint8_t> touched_;
  std::vector<LayerTimes> items_;
  std::vector<ItemPlayer> players_;
  std::vector<ActorPose> references_;  // [items], of additive layers
};

}  // namespace krok::timeline
