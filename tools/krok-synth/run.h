#pragma once

#include "tools/krok-synth/options.h"

namespace krok::cli::synth {

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::synth
