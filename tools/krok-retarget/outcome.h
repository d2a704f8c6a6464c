#pragma once

#include <string>

#include "retarget/retarget.h"
#include "tools/common/report.h"

namespace krok::retarget_tool {

// What is told of a finished transfer: names for the indices in its report.
struct Outcome {
  const Skeleton& source;
  const RoleMap& source_roles;
  const Skeleton& target;
  const RoleMap& target_roles;
  const retarget::Report& report;
};

// A line or two on what was done, for people.
std::string summary(const Outcome& outcome);

// Each joint of the target with the joints it takes its rotation from, and what has no partner.
std::string table(const Outcome& outcome);

Json to_json(const Outcome& outcome);

}  // namespace krok::retarget_tool
