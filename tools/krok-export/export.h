#pragma once

#include <optional>
#include <string>

#include "tools/common/tool.h"

namespace krok {

enum class ExportFormat { from_extension, bvh, glb, gltf, csv };

struct ExportOptions {
  std::string input;
  ExportFormat format = ExportFormat::from_extension;
  std::string unit;           // BVH: length unit; empty: centimetres
  std::optional<int> digits;  // BVH: decimal places of degrees and centimetres
  std::string order;          // BVH: of rotation channels, "ZXY"; empty: default
  std::string reduce;         // glTF: key reduction tolerance; empty: keep all keys
  std::optional<bool> bones;  // glTF: add a thin mesh of the skeleton; default yes
};

// File extension of a format, ".glb"; an Error (code usage) for from_extension.
Result<std::string> extension_of(ExportFormat format);

// Checks the options for values that are invalid for any file.
Status check_export(const ExportOptions& options);

// Reads a motion and writes it in the given format, or in that of the output's extension.
Result<int> run_export(const ExportOptions& options, ToolContext& context);

}  // namespace krok
