#pragma once

#include <string>

#include "core/result.h"

namespace krok::bench {

// Writes a BVH file of `frames` frames: the hierarchy of another, and its frames again and again.
// Its rows must stand a frame a line.
Status write_long_capture(const std::string& from, int frames, const std::string& to);

}  // namespace krok::bench
