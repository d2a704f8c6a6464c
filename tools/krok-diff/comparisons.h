#pragma once

#include "core/file.h"
#include "core/result.h"
#include "tools/cli/tool.h"
#include "tools/krok-diff/compare_files.h"
#include "tools/krok-diff/input_kinds.h"
#include "tools/krok-diff/outcome.h"

// The comparisons that compare_files() selects by file type. They write the requested plots and
// images.

namespace krok::cli::diff {

// Compares two motions, each a .anim file or a capture.
Result<Outcome> compare_motions(const InputFile& first, const InputFile& second,
                                const Options& options, ToolContext& context);

Result<Outcome> compare_models(const InputFile& first, const InputFile& second,
                               const Options& options, ToolContext& context);

Result<Outcome> compare_cameras(const InputFile& first, const InputFile& second,
                                const Options& options);

Result<Outcome> compare_morphs(const InputFile& first, const InputFile& second,
                               const Options& options);

// Compares files that can be read as scenes: glTF, models, motions, point caches.
Result<Outcome> compare_scenes(const InputFile& first, InputKind first_kind,
                               const InputFile& second, InputKind second_kind,
                               const Options& options, ToolContext& context);

}  // namespace krok::cli::diff
