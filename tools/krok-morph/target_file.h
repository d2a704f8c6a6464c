#pragma once

#include <string>

#include "core/file.h"
#include "core/result.h"
#include "scene/morph_set.h"
#include "tools/cli/tool.h"

namespace krok::cli::morph {

// An .exr of morph targets and the file it came from.
struct TargetFile {
  InputFile file;
  MorphSet morphs;
};
Result<TargetFile> read_targets(const std::string& path, ToolContext& context);

}  // namespace krok::cli::morph
