#pragma once

#include <string>

namespace krok::test {

// Files of version 1 of every format.
inline const std::string kFrozen = KROK_SOURCE_DIR "/tests/golden/v1/";

inline const std::string kWalk = KROK_SOURCE_DIR "/samples/captures/walk.bvh";

}  // namespace krok::test
