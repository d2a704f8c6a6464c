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
  std::optional<int> digits;  // BVH: decimals of degrees and centimetres
  std::string order;          // BVH: of rotation channels, "ZXY"; empty for the usual one
  std::string reduce;         // glTF: the tolerance for leaving out keys; empty to keep all
  std::optional<bool> bones;  // glTF: a thin mesh that shows the skeleton; yes if not said
};

// The extension of files in a format, ".glb"; an Error (code usage) for from_extension.
Result<std::string> extension_of(ExportFormat format);

// Whether the options have values that fit some file or other.
Status check_export(const ExportOptions& options);

// Reads a motion and writes it in the format of the output's extension or the one asked for.
Result<int> run_export(const ExportOptions& options, ToolContext& context);

}  // namespace krok
