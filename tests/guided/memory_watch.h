#pragma once

#include <cstdint>

// How much memory is in use, with AddressSanitizer; without it, nothing is counted.

namespace krok::guided {

// The largest sum of allocated bytes since begin_memory_watch(), beyond what was in use then.
void begin_memory_watch();
std::int64_t peak_memory();

}  // namespace krok::guided
