#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <vector>

#include "core/file.h"
#include "core/hash.h"
#include "core/temporary_files_internal.h"

namespace krok {

struct InputFile::Content {
  void* mapped = nullptr;
  std::size_t mapped_size = 0;
  std::size_t released = 0;  // what before is given back already
  std::vector<std::byte> owned;

  ~Content() {
    if (mapped != nullptr) munmap(mapped, mapped_size);
  }
};

InputFile::InputFile(std::string path, std::unique_ptr<Content> content)
    : path_(std::move(path)), content_(std::move(content)) {}
InputFile::InputFile(InputFile&&) noexcept = default;
InputFile& InputFile::operator=(InputFile&&) noexcept = default;
InputFile::~InputFile() = default;

std::span<const std::byte> InputFile::bytes() const {
  if (content_->mapped != nullptr) {
    return {static_cast<const std::byte*>(content_->mapped), content_->mapped_size};
  }
  return content_->owned;
}

std::string_view InputFile::text() const {
  const auto all = bytes();
  return {reinterpret_cast<const char*>(all.data()), all.size()};
}

std::uint64_t InputFile::checksum() const {
  constexpr std::size_t kStretch = std::size_t{4} << 20;
  const auto all = bytes();
  if (all.size() <= kStretch) return xxh3(all);
  Xxh3Stream stream;
  for (std::size_t at = 0; at < all.size(); at += kStretch) {
    stream.update(all.subspan(at, std::min(kStretch, all.size() - at)));
    release_before(at + kStretch);
  }
  return stream.digest();
}

void InputFile::release_before(std::size_t offset) const {
  constexpr std::size_t kStretch = std::size_t{4} << 20;  // worth a call; whole pages
  Content& content = *content_;
  if (content.mapped == nullptr) return;
  const std::size_t end = std::min(offset, content.mapped_size) / kStretch * kStretch;
  // Going back means that the file is read once more from its front.
  if (end < content.released) content.released = 0;
  if (end == content.released) return;
  // The mapping is private and nothing was written to it, so the file's bytes come back. Where the
  // system does not follow, nothing is lost but memory.
  (void)madvise(static_cast<std::byte*>(content.mapped) + content.released, end - content.released,
                MADV_DONTNEED);
  content.released = end;
}

Result<InputFile> InputFile::open(const std::string& path, std::uint64_t limit) {
  const bool standard_input = path == "-";
  const int descriptor = standard_input ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    if (errno == ENOENT || errno == ENOTDIR) {
      return file_error("file-missing", path, "no such file", "check the path");
    }
    return file_error("file-unreadable", path,
                      fmt::format("cannot be opened: {}", system_text(errno)));
  }
  struct Closer {
    int descriptor;
    ~Closer() {
      if (descriptor > STDERR_FILENO) ::close(descriptor);
    }
  } closer{descriptor};

  struct stat status {};
  if (fstat(descriptor, &status) != 0) {
    return file_error("file-unreadable", path,
                      fmt::format("cannot be examined: {}", system_text(errno)));
  }
  if (S_ISDIR(status.st_mode)) {
    return file_error("file-directory", path, "is a folder, not a file", "name a file inside it");
  }
  const auto too_large = [&] {
    return file_error("file-too-large", path, fmt::format("is larger than {} bytes", limit));
  };
  auto content = std::make_unique<Content>();
  if (S_ISREG(status.st_mode) && status.st_size > 0) {
    const auto size = static_cast<std::uint64_t>(status.st_size);
    if (size > limit) return too_large();
    void* mapped = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (mapped != MAP_FAILED) {
      content->mapped = mapped;
      content->mapped_size = size;
      return InputFile(path, std::move(content));
    }
  }
  // What cannot be mapped takes memory byte by byte, and a device may never end.
  limit = std::min(limit, InputFile::kStreamLimit);
  std::array<std::byte, 1 << 16> buffer;
  for (;;) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      return file_error("file-unreadable", path,
                        fmt::format("cannot be read: {}", system_text(errno)));
    }
    if (count == 0) break;
    content->owned.insert(content->owned.end(), buffer.begin(), buffer.begin() + count);
    if (content->owned.size() > limit) return too_large();
  }
  return InputFile(path, std::move(content));
}

}  // namespace krok
