#pragma once

#include <sys/uio.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Buffered appending to an open file, for OutputFile.

namespace krok {

class AppendedBytes {
 public:
  AppendedBytes() = default;
  // The caller keeps ownership of the descriptor. Streams are not flushed to disk.
  AppendedBytes(int descriptor, bool is_stream) : descriptor_(descriptor), is_stream_(is_stream) {}

  // Appends the parts in order. Bytes after the last full block stay buffered. Both return 0 or an
  // errno.
  int append(std::span<const std::span<const std::byte>> parts);
  // Writes the buffered bytes.
  int flush();

  // Bytes appended, including buffered ones.
  std::uint64_t size() const { return given_ + waiting_.size(); }
  // Bytes written for which writeback has not been started.
  std::uint64_t not_stored() const { return given_ - storing_; }

  // Starts writeback of what was written, so that a later sync takes less time. Failures are
  // reported by fsync() or syncfs().
  void start_storing();

  // Frees memory.
  void end();

 private:
  void plan(std::span<const std::byte> bytes);
  int carry_out();

  int descriptor_ = -1;
  bool is_stream_ = false;
  std::uint64_t given_ = 0;    // bytes written
  std::uint64_t storing_ = 0;  // of these, with writeback started
  std::vector<std::byte> waiting_;
  std::vector<iovec> planned_;  // to be written next
};

}  // namespace krok
