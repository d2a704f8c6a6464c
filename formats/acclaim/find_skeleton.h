#pragma once

#include <string>

#include "core/result.h"

namespace krok::acclaim {

// Where the skeleton of a motion was found, and why it is that one.
struct FoundSkeleton {
  std::string path;
  std::string reason;  // "its name begins the motion's"
};

// Looks beside the motion `amc_path` for its skeleton, a file that ends in .asf in any case: the
// one with the same name, or whose name the motion's begins with (01.asf for 01_01.amc, as the CMU
// collection has them; the longest such), or the only one in the folder. An Error (code
// acclaim-skeleton) where there is none or several are left.
Result<FoundSkeleton> find_skeleton(const std::string& amc_path);

}  // namespace krok::acclaim
