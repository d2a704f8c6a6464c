#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "motion/hips_root.h"
#include "scene/skeleton.h"
#include "timeline/base_motion.h"
#include "timeline/timeline.h"

namespace krok::timeline {

// The weight of each joint, 0 to 1, shape [joints]. Code timeline-mask, with the rule's location:
// a name or pattern that matches no joint, a weight outside 0 to 1, a negative soft edge.
Result<std::vector<double>> mask_weights(const Skeleton& skeleton, std::span<const MaskRule> rules);

// When an item of a layer is active.
struct LayerTimes {
  PlayedRange range;
  double start = 0, end = 0;
};

// Applies a layer's motions to poses. Const members are safe to call from several threads.
class LayerPlayer {
 public:
  // Codes timeline-mask, timeline-time, timeline-endless, timeline-weight and those of resolve(),
  // with the location of the error. `end` is the end of the base: items are cut there.
  // The sources' clips are those of `hips_root`.
  static Result<LayerPlayer> create(const Layer& layer, std::span<const Source> sources,
                                    const HipsRoot& hips_root, int carrier, double rate,
                                    double end);

  const std::vector<LayerTimes>& items() const { return items_; }

  // The weight of an item at a time, including fades.
  double weight(std::size_t item, double time) const;
  bool is_seen(double time) const;

  // 1 for joints that this layer moves and their descendants, [joints].
  const std::vector<std::uint8_t>& touched() const { return touched_; }

  // Changes the masked joints only.
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
