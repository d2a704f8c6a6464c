#pragma once

namespace krok {

// Removes the temporary files of all live OutputFiles (file.h), as the signal handlers do, for a
// program that is about to exit without unwinding. Threads that are about to create one are
// blocked. Does not allocate.
void remove_temporaries();

}  // namespace krok
