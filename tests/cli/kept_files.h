#pragma once

#include <string>

#include "support/this_build.h"

namespace krok::test {

// Files of version 1 of every format.
inline const std::string kFrozen = test::source_folder() + "/tests/golden/v1/";

inline const std::string kWalk = test::source_folder() + "/samples/captures/walk.bvh";

}  // namespace krok::test
