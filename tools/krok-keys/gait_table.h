#pragma once

#include <vector>

#include "contacts/gait_metrics.h"
#include "contacts/step_measures.h"
#include "core/result.h"
#include "formats/keys/keys.h"
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
    // A flight without progress is a kick or a jump on the spot.
    constexpr double kSlowestRun = 0.8;  // metres per second
    if (is_run() && steps.speed.value_or(0) < kSlowestRun) return "";
    return !steps.are_gait() ? "" : is_run() ? "run" : "walk";
  }
};
GaitFacts gait_facts(const Clip& clip, const RoleMap& roles, const std::vector<Keytime>& keytimes);
// What makes them doubtful: hips that jump (keys-jump), as where a path goes back to its start.
Diagnostics doubts_of_gait(const Clip& clip, const RoleMap& roles);

// Writes --table: a row for each motion, with keytimes of its sidecar or detected. Motions that
// cannot be read are reported and left out; the exit code then is kExitPartly.
Result<int> write_gait_table(const Options& options, ToolContext& context);

// Writes -o OUT.csv: a row for each keytime of each motion. Otherwise the same.
Result<int> write_event_table(const Options& options, ToolContext& context);

// Within so many seconds keytimes of a name are one.
inline constexpr double kSameKeytime = 0.15;

// Merges detected keys with manual edits: detected keytimes of the same name within kSameKeytime
// and detected contacts of the same joint that overlap are replaced.
krok::keys::Sidecar with_edits(MotionKeys found, const krok::keys::Sidecar& before);

// Applies the edits from the options. Codes: keys-none (nothing to remove), keys-joint, keys-time.
Status change(const Changes& changes, const Clip& clip, krok::keys::Sidecar& sidecar);

}  // namespace krok::cli::keys
