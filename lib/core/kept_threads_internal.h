#pragma once

#include <cstddef>
#include <functional>

// The thread pool of the loops in parallel.h. Threads are created on first use and sleep in
// between, since creating one takes as long as skinning a mesh. They are joined at program exit.
//
// Not oneTBB: with an arena for each call, a loop of 4,096 short items took 110 us instead of 1.4
// us on two cores, calls that wait for each other did not end, and its threads do not survive
// fork().

namespace krok {

// Calls `work`, which must not throw, on this thread and concurrently on up to `helpers` others,
// and returns when all calls are done. Once the first call returns, no further one starts. Can be
// called on several threads and from within `work`: nobody waits for a thread that has not started,
// so there is no deadlock.
//
// The pool never has more threads than all outermost calls in progress request together, or than
// the machine has cores if nested calls request more. A child of fork() has none of them and
// creates its own; it must not return into a call that its parent was in.
void call_on_kept_threads(std::size_t helpers, const std::function<void()>& work);

}  // namespace krok
