#pragma once

#include "compare_files.h"
#include "core/file.h"
#include "core/result.h"
#include "input_kinds.h"
#include "outcome.h"
#include "tools/common/tool.h"

// The comparisons that compare_files() chooses from, each of two files of kinds that it takes. They
// draw what is wanted of the difference.

namespace krok::diff {

// Two motions, either of them a .anim file or a capture.
Result<Outcome> compare_motions(const InputFile& first, const InputFile& second,
                                const Options& options, ToolContext& context);

Result<Outcome> compare_models(const InputFile& first, const InputFile& second,
                               const Options& options, ToolContext& context);

Result<Outcome> compare_cameras(const InputFile& first, const InputFile& second,
                                const Options& options);

Result<Outcome> compare_morphs(const InputFile& first, const InputFile& second,
                               const Options& options);

// Files of kinds that can be seen as scenes: glTF, models, motions, point caches.
Result<Outcome> compare_scenes(const InputFile& first, InputKind first_kind,
                               const InputFile& second, InputKind second_kind,
                               const Options& options, ToolContext& context);

}  // namespace krok::diff
