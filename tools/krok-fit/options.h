#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "rbf/weight_function.h"
#include "tools/cli/tool.h"

namespace krok::cli::fit {

struct Options {
  std::vector<std::string> inputs;  // a description, or motions
  bool keep_going = false;
  std::optional<rbf::Kernel> kernel;  // not set: automatic
  std::optional<int> refine;          // max points to insert; not set: 40 per parameter
  std::optional<double> smooth;       // 0: interpolate; not set: automatic
  std::optional<double> until;        // metres: accepted error of length parameters
  int held_out = 0;                   // 0: default of refine()
  std::uint64_t seed = 1;
  bool polish = true;  // optimise inserted weights jointly after refinement
  std::string resume;  // a library to continue from
  std::string plots;   // output folder

  const std::string& first() const { return inputs.front(); }
};

// Max examples for leave-one-out errors: the time grows with the fourth power of their number.
inline constexpr std::size_t kMaxLeftOut = 128;

// Max points for --refine.
inline constexpr int kMaxRefined = 4000;

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads, fits, writes, reports.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::fit
