#pragma once

#include <cstddef>
#include <functional>

// Loops over independent items. Results must not depend on the order: each item writes its own
// place, so that the same bytes come out for every number of threads.

namespace krok {

// The number of threads that `jobs` asks for: itself if positive, otherwise what the machine has.
int thread_count(int jobs);

// Calls body(begin, end) for consecutive ranges that together cover [0, count), each of at most
// `grain` items, on up to `jobs` threads (the calling one included; 1 runs in order on it alone).
// Ranges begin at multiples of `grain` whatever `jobs` is. If a body throws, ranges not yet
// begun are skipped and the exception of the first range that threw (first in order, the same for
// any `jobs`) is rethrown here.
void parallel_for(std::size_t count, std::size_t grain, int jobs,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

}  // namespace krok
