#pragma once

#include <span>
#include <vector>

#include "motion/hips_root.h"
#include "timeline/base_motion.h"
#include "timeline/layer_player.h"
#include "timeline/mix.h"

// The parts of mix() that report on its result.

namespace krok::timeline {

struct Parts {
  const Timeline& timeline;
  std::span<const Source> sources;
  const BaseMotion& base;
  std::span<const LayerPlayer> layers;
  const Clip& clip;  // the result
  int jobs;
  const HipsRoot& hips_root;  // of the sources' clips and the result
  const RoleMap& roles;
};

// Keytimes and contacts of the base where they are still valid.
MotionKeys result_keys(const Parts& parts);

// By time, the base first. Code timeline-time for a mark outside its item; a source mark that is
// never reached is a warning.
Result<std::vector<Event>> result_events(const Parts& parts, Diagnostics& warnings);

std::vector<ItemFacts> result_items(const Parts& parts);

// Warns about joints that jump at the seam of a loop, or where a layer's item begins or ends.
std::vector<ChangeFacts> result_changes(const Parts& parts, Diagnostics& warnings);

}  // namespace krok::timeline
