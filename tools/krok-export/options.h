#pragma once

#include <optional>
#include <string>

#include "tools/cli/tool.h"

namespace krok::cli::exporting {

enum class ExportFormat { from_extension, bvh, glb, gltf, csv, mot, sto };

// The series in a table.
enum class What : unsigned char {
  automatic,  // positions; for OpenSim angles
  positions,
  local,
  angles,
  quaternions,
  velocities,
  contacts
};
enum class Layout : unsigned char { automatic, long_rows, wide };

struct Options {
  std::string input;
  ExportFormat format = ExportFormat::from_extension;
  std::string unit;                   // BVH: length unit; empty: centimetres
  std::optional<int> digits;          // BVH: decimal places of degrees and centimetres
  bool root_offset = false;           // BVH: write the root's reference position
  std::string order;                  // BVH: of rotation channels, "ZXY"; empty: default
  std::string reduce;                 // glTF: key reduction tolerance; empty: keep all keys
  What what = What::automatic;        // tables
  Layout layout = Layout::automatic;  // CSV; automatic: long
  std::string map;                    // role map for angles and contacts, or empty
  std::optional<bool> bones;          // glTF: add a thin mesh of the skeleton; default yes
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
