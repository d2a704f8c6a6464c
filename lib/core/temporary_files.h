#pragma once

namespace krok {

// Removes the temporary files of all living OutputFiles (file.h), as a signal does, for a program
// that is about to end without leaving its scopes. Those that other threads are about to begin are
// not begun. Takes no memory.
void remove_temporaries();

}  // namespace krok
