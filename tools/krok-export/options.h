#pragma once

#include <optional>
#include <string>

#include "tools/cli/tool.h"

namespace krok::cli::exporting {

enum class ExportFormat { from_extension, bvh, glb, gltf, csv };

struct Options {
  std::string input;
  ExportFormat format = ExportFormat::from_extension;
  std::string unit;           // BVH: length unit; empty: centimetres
  std::optional<int> digits;  // BVH: decimal places of degrees and centimetres
  std::string order;          // BVH: of rotation channels, "ZXY"; empty: default
  std::string reduce;         // glTF: key reduction tolerance; empty: keep all keys
  std::optional<bool> bones;  // glTF: add a thin mesh of the skeleton; default yes
};

// Checks the options for a format. Codes usage, export-unit.
Status check_for(ExportFormat format, const Options& options);

// Length of a BVH unit in metres.
Result<double> unit_of(const Options& options, ExportFormat format);

// The tolerance of --reduce in metres.
Result<double> reduce_tolerance(const Options& options);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::exporting
