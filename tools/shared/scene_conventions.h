#pragma once

#include "capture/convention_choice.h"
#include "character/rig.h"
#include "core/result.h"
#include "nodes/evaluate.h"

namespace krok::cli {

// Unit and axes of a scene from character::find_conventions, sampling the given animation (-1:
// none). `rig` may be null; `roles` are those of its joints.
Result<Conventions> scene_conventions(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                      const character::Rig* rig, const RoleMap& roles,
                                      int animation, const GivenConventions& given);

}  // namespace krok::cli
