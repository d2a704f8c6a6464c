#pragma once

#include <atomic>

// The number of calls of operator new, counted by counted_allocations.cpp in the whole program that
// it is linked into.

namespace krok::test {

inline std::atomic<long> allocations{0};

}  // namespace krok::test
