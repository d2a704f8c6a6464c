#pragma once

#include <sys/types.h>

#include <atomic>
#include <string>

#include "core/result.h"

// The temporary files that results are written to before they get their names.

namespace krok {

// An Error about a file, with its code.
Error file_error(const char* code, const std::string& path, std::string message,
                 std::string hint = {});

// What the system says of an errno.
std::string system_text(int error_number);

struct Temporary {
  std::string path;
  int descriptor = -1;
  std::atomic<int>* slot = nullptr;  // where a signal finds it
};

// A new file in `folder`, private to the user. Its name is remembered before it exists, so that a
// signal at any moment removes it. errno tells why the descriptor is -1.
Temporary create_temporary(const std::string& folder);

// For a temporary file that is there no more; null is fine.
void forget_temporary(std::atomic<int>* slot);

// A new file in `folder` that has no name, and is gone with its descriptor however the program
// ends; -1 where the system or the file system has none such. It is created without holding up
// others that make files in the same folder.
int create_unnamed(const std::string& folder);

// Where a file without a name can be read.
std::string path_of_unnamed(int descriptor);

// Gives a file without a name this one. Returns 0 or an errno, EEXIST where something stands there.
int name_unnamed(int descriptor, const std::string& path);

// Gives a file without a name a temporary one in `folder`, as create_temporary() does; the
// descriptor in the result is `unnamed`, or -1 where errno tells why that failed.
Temporary name_as_temporary(int unnamed, const std::string& folder);

// The process's file mode mask. It can only be read by setting it, which would race between
// threads, so that is done once.
mode_t mode_mask();

}  // namespace krok
