#pragma once

#include <sys/types.h>

#include <atomic>
#include <string>

#include "core/result.h"

// Temporary files that outputs are written to before they are renamed.

namespace krok {

// An Error with a code and the path of a file.
Error file_error(const char* code, const std::string& path, std::string message,
                 std::string hint = {});

// The system's message for an errno.
std::string system_text(int error_number);

struct Temporary {
  std::string path;
  int descriptor = -1;
  std::atomic<int>* slot = nullptr;  // for the signal handler
};

// Creates a file in `folder`, readable by the user only. Its name is registered before it exists,
// so that a signal at any moment removes it. errno is set if the descriptor is -1.
Temporary create_temporary(const std::string& folder);

// remove_temporaries_of_killed(folder), the first time that this process writes there.
void tidy_once(const std::string& folder);

// Unregisters a temporary file that no longer exists; null is allowed.
void forget_temporary(std::atomic<int>* slot);

// Creates a file in `folder` without a name, which disappears with its descriptor however the
// program ends; -1 if the system or the file system does not support that. Does not block others
// that create files in the same folder.
int create_unnamed(const std::string& folder);

// The path where a file without a name can be read.
std::string path_of_unnamed(int descriptor);

// Names a file without a name. Returns 0 or an errno, EEXIST if `path` exists.
int name_unnamed(int descriptor, const std::string& path);

// Gives a file without a name a temporary one in `folder`, as create_temporary() does; the
// descriptor in the result is `unnamed`, or -1 with errno set on failure.
Temporary name_as_temporary(int unnamed, const std::string& folder);

// The process's umask. It can only be read by setting it, which would race between threads, so it
// is read once.
mode_t mode_mask();

}  // namespace krok
