#pragma once

#include <cstddef>
#include <functional>

// The threads that the loops of parallel.h share. They are made when they are first needed and
// sleep in between, for making one takes as long as skinning a mesh does. The program's end joins
// them.

namespace krok {

// Calls `work`, which must not throw, on this thread and at once on up to `helpers` others, and
// returns when all of these are done. Once the first of them is done, no further one begins. Calls
// can be made on several threads, and within each other's work: nobody waits for a thread that has
// not begun, so that none waits forever.
//
// There are never more threads than the calls in progress that are not within others ask for
// together, or than the machine has cores where those within ask for more. A child that fork()
// makes has none of them and makes its own; it must not return into a call that its parent was in.
void call_on_kept_threads(std::size_t helpers, const std::function<void()>& work);

}  // namespace krok
