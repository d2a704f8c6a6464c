#pragma once

#include <cstddef>
#include <functional>

#include "core/result.h"

// Loops over independent items. Results must not depend on the order: each item writes its own
// place, so that the same bytes come out for every number of threads.
//
// The threads are made when they are first needed and kept; they sleep between loops, after a short
// while in which the next loop finds them awake. Loops can be started on several threads and within
// each other. Those within others make no further threads beyond the machine's cores, and none of
// them waits for a thread that does something else. A child that fork() makes has threads of its
// own, but must not go on with a loop that its parent was in.

namespace krok {

// The number of threads that `jobs` asks for: itself if positive, otherwise what the machine has.
int thread_count(int jobs);

// Calls `work` on up to `threads` threads at once, this one included, and returns when all are
// done. It is called on fewer where the system gives fewer threads, where they are busy, and where
// one is done before others have begun, which then do not begin; `work` must be right for any
// number of them. If it throws, one of the exceptions is rethrown here.
void on_threads(std::size_t threads, const std::function<void()>& work);

// Calls body(begin, end) for consecutive ranges that together cover [0, count), each of at most
// `grain` items, on up to `jobs` threads (the calling one included; 1 runs in order on it alone).
// Ranges begin at multiples of `grain` whatever `jobs` is. If a body throws, ranges not yet
// begun are skipped and the exception of the first range that threw (first in order, the same for
// any `jobs`) is rethrown here.
void parallel_for(std::size_t count, std::size_t grain, int jobs,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

// Makes `count` items on up to `jobs` threads (as in parallel_for) and hands them over in order.
// make(i, slot) fills what belongs to `slot`, a number from 0 to slots_for(jobs) - 1 that no other
// item in work has, so that memory for items may be kept there; take(i, slot) is called for 0, 1,
// 2, ... one after the other, on any thread, while others go on making. The first make or take that
// is not ok() ends the work; its Error is returned, the same for any `jobs`. What is thrown is
// thrown on.
Status make_in_order(std::size_t count, int jobs,
                     const std::function<Status(std::size_t item, std::size_t slot)>& make,
                     const std::function<Status(std::size_t item, std::size_t slot)>& take);
std::size_t slots_for(int jobs);

}  // namespace krok
