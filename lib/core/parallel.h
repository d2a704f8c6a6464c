#pragma once

#include <cstddef>
#include <functional>

#include "core/result.h"

// Parallel loops over independent items. Results must not depend on the order: each item writes
// only its own output, so that results are the same bytes for any number of threads.
//
// Threads are created on first use and kept; between loops they spin briefly, then sleep. Loops can
// be started on several threads and can be nested. Nested loops create no threads beyond the number
// of cores and never wait for a thread that is busy elsewhere. A child of fork() gets its own
// threads, but must not continue a loop that its parent was in.

namespace krok {

// The number of threads for `jobs`: `jobs` itself if positive, otherwise the number of hardware
// threads.
int thread_count(int jobs);

// Calls `work` on up to `threads` threads at once, including this one, and returns when all calls
// are done. Fewer calls are made if the system provides fewer threads, if threads are busy, or if
// one call returns before others have started; `work` must be correct for any number of calls. If
// it throws, one of the exceptions is rethrown here.
void on_threads(std::size_t threads, const std::function<void()>& work);

// Calls body(begin, end) for consecutive ranges that together cover [0, count), each of at most
// `grain` items, on up to `jobs` threads (including this one; 1 runs in order on this thread).
// Ranges start at multiples of `grain` for any `jobs`. If a body throws, ranges not yet started are
// skipped, and the exception of the first range that threw (first in order, the same for any
// `jobs`) is rethrown here.
void parallel_for(std::size_t count, std::size_t grain, int jobs,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

// Makes `count` items on up to `jobs` threads (as in parallel_for) and consumes them in order.
// make(i, slot) fills the buffers of `slot`, a number from 0 to slots_for(jobs) - 1 that no other
// item in progress has, so that memory can be reused per slot. take(i, slot) is called for 0, 1, 2,
// ... sequentially, on any thread, while others keep making. The first make or take that is not
// ok() stops the loop; its Error is returned, the same for any `jobs`. Exceptions are rethrown.
Status make_in_order(std::size_t count, int jobs,
                     const std::function<Status(std::size_t item, std::size_t slot)>& make,
                     const std::function<Status(std::size_t item, std::size_t slot)>& take);
std::size_t slots_for(int jobs);

}  // namespace krok
