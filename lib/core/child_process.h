#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

// Runs work that may crash, hang or exhaust memory in a child process: a fork of the caller, with
// limits, that returns bytes. Can be called from several threads at once; each call waits for its
// child and leaks neither a process nor a descriptor.

namespace krok {

struct ChildLimits {
  double seconds = 60;  // of CPU time; wall-clock time is limited to ten times that
  // Address space beyond what is in use when the child starts. Not enforced in sanitizer builds,
  // which reserve terabytes.
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;
  std::uint64_t result_bytes = std::uint64_t{1} << 30;
};

// What a user set instead of a reader's own limits.
struct GivenLimits {
  std::optional<double> seconds;              // > 0
  std::optional<std::uint64_t> memory_bytes;  // > 0
};

enum class ChildEnd : unsigned char {
  returned,          // `bytes` is the result of the work
  threw,             // the work threw an exception other than std::bad_alloc; see `what`
  crashed,           // killed by `signal`, or the process exited (signal 0, see `what`)
  out_of_time,       // at the limit of CPU time, or of wall-clock time (signal 0); see `what`
  out_of_memory,     // an allocation failed or exceeded the limit
  result_too_large,  // more than `result_bytes`
  not_started,       // the system could not start a process; see `what`
};

struct ChildReport {
  ChildEnd end = ChildEnd::not_started;
  int signal = 0;
  std::string what;
  // Untrusted, since the process may have been compromised: validate before use.
  std::vector<std::byte> bytes;
};

// Runs `work` in a child process and waits. The child works on a copy of the caller's memory and
// has one thread. Standard input is empty, output is discarded, and no file or socket can be opened
// (except in sanitizer builds), so its input must be in memory, mapped files included. It writes no
// core dump and dies with the caller. Locks held by other threads of the caller stay locked in the
// child: `work` may allocate memory and throw, but must not use a lock of the program that another
// thread may hold.
ChildReport run_in_child(const std::function<std::vector<std::byte>()>& work,
                         const ChildLimits& limits = {});

// Such as "segmentation fault"; "signal 64" for signals without a name.
std::string signal_text(int signal);

}  // namespace krok
