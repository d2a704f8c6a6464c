#pragma once

#include <sys/uio.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Bytes on their way to the end of an open file: OutputFile's.

namespace krok {

class AppendedBytes {
 public:
  AppendedBytes() = default;
  // Of a descriptor that stays the caller's. A stream is not told to be stored.
  AppendedBytes(int descriptor, bool is_stream) : descriptor_(descriptor), is_stream_(is_stream) {}

  // Appends the parts one behind the other. What is left of the last whole stretch waits. Both
  // return 0 or the system's error.
  int append(std::span<const std::span<const std::byte>> parts);
  // Gives what waits to the system.
  int flush();

  // How many bytes were appended, whether or not they wait.
  std::uint64_t size() const { return given_ + waiting_.size(); }
  // How many the system was given and not yet told to store.
  std::uint64_t not_stored() const { return given_ - storing_; }

  // Has the disk begin with what was given, so that whoever waits at the end does not wait long.
  // Only a beginning: what fails here, fsync() or syncfs() tells.
  void start_storing();

  // Lets go of memory.
  void end();

 private:
  void plan(std::span<const std::byte> bytes);
  int carry_out();

  int descriptor_ = -1;
  bool is_stream_ = false;
  std::uint64_t given_ = 0;    // to the system
  std::uint64_t storing_ = 0;  // of these, told to be stored
  std::vector<std::byte> waiting_;
  std::vector<iovec> planned_;  // what is given next
};

}  // namespace krok
