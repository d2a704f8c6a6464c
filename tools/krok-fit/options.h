#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/result.h"
#include "rbf/weight_function.h"
#include "tools/common/command_options.h"

namespace krok::fit_tool {

struct Options {
  std::string library;  // the description's path
  bool keep_going = false;
  rbf::Kernel kernel = rbf::Kernel::cubic;
  std::optional<int> refine;           // points to insert at most; nothing: 40 for each parameter
  std::optional<double> smooth = 0.0;  // 0: weights meet the examples; nothing: chosen
  std::string until;                   // a length: the error at which lengths are good enough
  int held_out = 0;                    // 0: as refine() chooses
  std::uint64_t seed = 1;
  bool polish = true;  // inserted weights together, after refinement
  std::string resume;  // a library to go on with
  std::string plots;   // a folder
};

// Each example is made by the others alone for at most so many of them: it takes time with the
// fourth power of their number.
inline constexpr std::size_t kMaxLeftOut = 128;

// Points that --refine may ask for.
inline constexpr int kMaxRefined = 4000;

void declare(CommandOptions& command, Options& options);
Status check(const Options& options);

}  // namespace krok::fit_tool
