#pragma once

#include <optional>
#include <string>

#include "tools/common/tool.h"

namespace krok {

enum class ExportFormat { from_extension, bvh, glb, gltf, csv };

struct ExportOptions {
  std::string input;
  ExportFormat format = ExportFormat::from_extension;
  std::string unit;           // BVH: of lengths; empty for centimetres
  std::optional<bool> bones;  // glTF: a thin mesh that shows the skeleton; yes if not said
};

// Reads a motion and writes it in the format of the output's extension or the one asked for.
Result<int> run_export(const ExportOptions& options, ToolContext& context);

}  // namespace krok
