#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "math/transform.h"
#include "tools/cli/tool.h"

namespace krok::cli::synth {

enum class SideChoice : unsigned char { library, left, right };

struct Options {
  std::string library;
  std::vector<std::string> set;  // NAME=VALUE
  std::string table;
  SideChoice side = SideChoice::library;
  bool correct = false;
  bool extrapolate = false;
  bool strict = false;
  bool plant = false;
  std::string after;         // a motion that is continued
  bool in_sequence = false;  // all rows in one motion
  double transition = 0;     // seconds
  std::optional<Vec3> place;
  double rate = 0;  // 0: the library's
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::synth
