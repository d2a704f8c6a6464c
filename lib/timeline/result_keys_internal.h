#pragma once

#include <span>
#include <vector>

#include "timeline/base_motion.h"
#include "timeline/layer_player.h"
#include "timeline/mix.h"

// Parts of mix() that tell what is in its result.

namespace krok::timeline {

struct Parts {
  const Timeline& timeline;
  std::span<const Source> sources;
  const BaseMotion& base;
  std::span<const LayerPlayer> layers;
  const Clip& clip;  // the result
  int jobs;
};

// Keytimes and contacts of the base where they still hold.
MotionKeys result_keys(const Parts& parts);

// By time, those of the base first. Code timeline-time for a mark outside its item; a mark of a
// moment of the source that never comes is a warning.
Result<std::vector<Event>> result_events(const Parts& parts, Diagnostics& warnings);

std::vector<ItemFacts> result_items(const Parts& parts);

// Warns of seams between rounds where a joint jumps.
std::vector<ChangeFacts> result_changes(const Parts& parts, Diagnostics& warnings);

}  // namespace krok::timeline
