#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/result.h"
#include "retarget/retarget.h"
#include "tools/cli/report.h"

// What krok-retarget and krok-skin --retarget have in common.

namespace krok::cli {

// The outcome of a retarget, with names for the indices in its report.
struct Outcome {
  const Skeleton& source;
  const RoleMap& source_roles;
  const Skeleton& target;
  const RoleMap& target_roles;
  const krok::retarget::Report& report;
};

// One or two lines for display.
std::string summary(const Outcome& outcome);

// Table of the target's joints with their source joints, and of unmapped joints.
std::string table(const Outcome& outcome);

Json to_json(const Outcome& outcome);

// What was chosen where the input left it open, as notes and warnings (codes retarget-...), without
// a file. `pose_is_given`: the input's reference pose was.
Diagnostics choices_of(const Outcome& outcome, bool pose_is_given);

// The height of the floor under a skeleton that a mesh hangs on: the mesh's lowest point. None
// where it is far above or below the feet, or the skeleton is no humanoid.
std::optional<double> floor_below(std::span<const Vec3f> mesh, const Skeleton& skeleton,
                                  const RoleMap& roles);

}  // namespace krok::cli
