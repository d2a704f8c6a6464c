#pragma once

#include "core/file.h"
#include "description.h"
#include "roles/roles.h"
#include "scene/skeleton.h"

namespace krok::info {

// How what the joints are is to be found out and shown.
struct SkeletonOptions {
  const InputFile* map = nullptr;  // a role map, or none
  bool verbose = false;            // list every joint
};

// Joints, end sites, which parts of a body they are, and which of a humanoid's are missing; each
// joint with its role in JSON, and with `verbose` in the text too. An Error where the map does not
// fit the skeleton.
Status add_skeleton(const Skeleton& skeleton, const SkeletonOptions& options, Description& out);

}  // namespace krok::info
