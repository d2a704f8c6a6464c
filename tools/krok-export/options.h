#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/conventions.h"
#include "tools/cli/tool.h"

namespace krok::cli::exporting {

enum class ExportFormat { from_extension, bvh, glb, gltf, csv, npz, mot, sto };

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
enum class Layout : unsigned char { long_rows, wide };

struct Options {
  std::vector<std::string> inputs;  // several for a table in CSV alone
  ExportFormat format = ExportFormat::from_extension;
  Unit unit;                          // BVH
  int digits = 0;                     // BVH: decimal places of degrees and centimetres
  bool root_offset = false;           // BVH: write the root's reference position
  std::string order;                  // BVH: of rotation channels, "ZXY"
  std::optional<double> reduce;       // glTF: key reduction tolerance, metres; empty: all keys
  What what = What::automatic;        // tables
  Layout layout = Layout::long_rows;  // CSV
  std::string map;                    // role map for angles and contacts, or empty
  bool bones = true;                  // glTF: add a thin mesh of the skeleton

  const std::string& input() const { return inputs.front(); }

  // Whether an option, "--unit", was given; set by declare().
  std::function<bool(const char* option)> given;
};

// What is written: by --format, else by the output's extension. Code export-format.
Result<ExportFormat> format_of(const Options& options, const std::string& output);

// Checks the options for a format. Codes usage, export-unit.
Status check_for(ExportFormat format, const Options& options);

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads a motion and writes it in the given format, or in that of the output's extension.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::exporting
