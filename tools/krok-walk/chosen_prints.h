#pragma once

#include <span>
#include <vector>

#include "gait/print.h"
#include "gait/step_library.h"
#include "terrain/terrain.h"
#include "tools/krok-walk/options.h"

namespace krok::cli::walk {

// The footprints to walk on: those of a file, or planned along a way or to goals.
Result<std::vector<gait::Print>> choose_prints(const Options& options,
                                               std::span<const gait::StepLibrary> libraries,
                                               const Terrain& ground, ToolContext& context);

}  // namespace krok::cli::walk
