#pragma once

#include <atomic>

// How often the program took memory by operator new: counted_allocations.cpp beside this counts it,
// for the whole program that it is linked into.

namespace krok::test {

inline std::atomic<long> allocations{0};

}  // namespace krok::test
