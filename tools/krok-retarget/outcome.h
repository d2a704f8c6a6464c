#pragma once

#include <string>

#include "retarget/retarget.h"
#include "tools/cli/report.h"

namespace krok::cli::retarget {

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

}  // namespace krok::cli::retarget
