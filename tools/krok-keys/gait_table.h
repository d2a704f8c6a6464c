#pragma once

#include <vector>

#include "contacts/gait_metrics.h"
#include "contacts/step_measures.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"
#include "tools/cli/tool.h"
#include "tools/krok-keys/options.h"

namespace krok::cli::keys {

// What a motion's gait is like.
struct GaitFacts {
  GaitMetrics gait;
  StepMeasures steps;
  double slide_speed = 0;  // metres per second
  // Where both feet fly, no foot could be still: the slide says nothing.
  bool is_run() const { return gait.cycles > 0 && gait.double_support <= 0; }
  // Empty where no gait shows.
  const char* name() const {
    if (!steps.are_steady()) return "unsteady";
    // Feet that are down for half of a cycle and more do not fly.
    if (is_run() && gait.stance[0] + gait.stance[1] >= 1) return "";
    return !steps.are_gait() ? "" : is_run() ? "run" : "walk";
  }
};
GaitFacts gait_facts(const Clip& clip, const RoleMap& roles, const std::vector<Keytime>& keytimes);

// Writes --table: a row for each motion, with keytimes of its sidecar or detected. Motions that
// cannot be read are reported and left out; the exit code then is kExitPartly.
Result<int> write_gait_table(const Options& options, ToolContext& context);

// Writes -o OUT.csv: a row for each keytime of each motion. Otherwise the same.
Result<int> write_event_table(const Options& options, ToolContext& context);

}  // namespace krok::cli::keys
