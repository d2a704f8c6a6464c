#include <fcntl.h>

#include <algorithm>
#include <cerrno>

#include "core/appended_bytes_internal.h"

namespace krok {

namespace {

// Aligned blocks of the file, which the system caches in large pieces at half the cost.
constexpr std::uint64_t kFlushedBytes = std::uint64_t{1} << 18;
constexpr std::uint64_t kWorthStoring = std::uint64_t{8} << 20;
constexpr std::size_t kMaxParts = 1024;  // per system call (IOV_MAX)

}  // namespace

int AppendedBytes::append(std::span<const std::span<const std::byte>> parts) {
  std::uint64_t end = size();
  for (const auto part : parts) end += part.size();
  const std::uint64_t whole = end / kFlushedBytes * kFlushedBytes;
  std::size_t now = whole > size() ? static_cast<std::size_t>(whole - size()) : 0;
  if (now > 0) {
    plan(waiting_);
    std::size_t left = now;
    for (const auto part : parts) {
      const auto here = part.first(std::min(left, part.size()));
      plan(here);
      left -= here.size();
    }
    if (const int trouble = carry_out(); trouble != 0) return trouble;
    waiting_.clear();
  }
  for (const auto part : parts) {
    const std::size_t gone = std::min(now, part.size());
    now -= gone;
    const auto rest = part.subspan(gone);
    waiting_.insert(waiting_.end(), rest.begin(), rest.end());
  }
  return 0;
}

int AppendedBytes::flush() {
  plan(waiting_);
  if (const int trouble = carry_out(); trouble != 0) return trouble;
  waiting_.clear();
  return 0;
}

void AppendedBytes::plan(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  planned_.push_back({const_cast<std::byte*>(bytes.data()), bytes.size()});
}

int AppendedBytes::carry_out() {
  std::span<iovec> left = planned_;
  while (!left.empty()) {
    const auto at_once = static_cast<int>(std::min(left.size(), kMaxParts));
    const ssize_t count = ::writev(descriptor_, left.data(), at_once);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int trouble = errno;
      planned_.clear();
      return trouble;
    }
    given_ += static_cast<std::uint64_t>(count);
    auto done = static_cast<std::size_t>(count);
    while (!left.empty() && done >= left.front().iov_len) {
      done -= left.front().iov_len;
      left = left.subspan(1);
    }
    if (done > 0) {
      left.front().iov_base = static_cast<std::byte*>(left.front().iov_base) + done;
      left.front().iov_len -= done;
    }
  }
  planned_.clear();
  if (!is_stream_ && not_stored() >= kWorthStoring) start_storing();
  return 0;
}

void AppendedBytes::start_storing() {
  (void)sync_file_range(descriptor_, static_cast<off_t>(storing_), static_cast<off_t>(not_stored()),
                        SYNC_FILE_RANGE_WRITE);
  storing_ = given_;
}

void AppendedBytes::end() {
  std::vector<std::byte>().swap(waiting_);
  std::vector<iovec>().swap(planned_);
}

}  // namespace krok
