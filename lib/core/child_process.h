#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

// Work that may crash, hang or eat memory, done in a process of its own: a fork of the calling one,
// with limits, that hands back bytes. What calls may be made from several threads at once; each
// call waits for its child, and leaves neither a process nor a descriptor behind.

namespace krok {

struct ChildLimits {
  double seconds = 60;  // of wall-clock time; of processor time the same, rounded up
  // Of address space beyond what the caller has when the child begins. Not held in builds with a
  // sanitizer, which reserve terabytes.
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;
  std::uint64_t result_bytes = std::uint64_t{1} << 30;
};

enum class ChildEnd : unsigned char {
  returned,          // the work was done; `bytes` is what it returned
  threw,             // it ended by an exception, other than for want of memory; `what` tells
  crashed,           // it died by `signal`, or ended the process (signal 0, `what` tells how)
  out_of_time,       // it was stopped at its limit
  out_of_memory,     // memory beyond its limit was asked for
  result_too_large,  // it returned more than `result_bytes`
  not_started,       // the system would not start a process; `what` tells why
};

struct ChildReport {
  ChildEnd end = ChildEnd::not_started;
  int signal = 0;
  std::string what;
  // From a process that may have been led astray: whoever reads them trusts nothing.
  std::vector<std::byte> bytes;
};

// Calls `work` in a child and waits. The child sees the caller's memory as it is now, changes
// nothing of it, and has one thread. It has no standard input, what it prints is dropped, and it
// can open nothing (but in builds with a sanitizer): no file, no socket (what it is to read must be
// in memory, mapped files included). It writes no core dump, and dies with the caller. Of the
// caller's threads the child inherits nothing but locks that they held: `work` may allocate memory
// and throw, but must use no lock of the program's that another thread may hold.
ChildReport run_in_child(const std::function<std::vector<std::byte>()>& work,
                         const ChildLimits& limits = {});

// "segmentation fault" and the like; "signal 64" for those without a name.
std::string signal_text(int signal);

}  // namespace krok
