#pragma once

#include <string>

#include "core/result.h"

namespace krok::acclaim {

// The skeleton file of a motion, and why it was chosen.
struct FoundSkeleton {
  std::string path;
  std::string reason;    // "the motion's name begins with its name"
  bool by_name = false;  // not because it is the only one
};

// Searches the folder of the motion `amc_path` for its skeleton, a file with extension .asf
// (case-insensitive): the longest name that equals or begins the motion's name (01.asf for
// 01_01.amc, as in the CMU database), or else the only one in the folder. An Error (code
// acclaim-skeleton) if there is none or the choice is ambiguous.
Result<FoundSkeleton> find_skeleton(const std::string& amc_path);

}  // namespace krok::acclaim
