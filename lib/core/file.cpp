#include "core/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <optional>

#include "core/hash.h"
#include "core/temporary_files_internal.h"

namespace krok {

Error file_error(const char* code, const std::string& path, std::string message, std::string hint) {
  return Error(code, std::move(message), std::move(hint)).in_file(path);
}

std::string system_text(int error_number) {
  return std::strerror(error_number);
}

std::string base_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string extension(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

namespace {

constexpr std::size_t kHashedBytes = std::size_t{4} << 20;  // large enough per call; whole pages

}  // namespace

struct InputFile::Content {
  void* mapped = nullptr;
  std::size_t mapped_size = 0;
  std::size_t released = 0;  // bytes before this are released
  std::unique_ptr<std::byte[]> read;
  std::size_t read_size = 0;
  // The checksum of the bytes before `summed`. A mapped file that is released front to back is
  // hashed on the way, while its pages are in memory.
  std::optional<Xxh3Stream> sum;
  std::size_t summed = 0;

  ~Content() {
    if (mapped != nullptr) munmap(mapped, mapped_size);
  }

  void sum_up_to(std::size_t end) {
    if (end <= summed) return;
    if (!sum) sum.emplace();
    sum->update({static_cast<const std::byte*>(mapped) + summed, end - summed});
    summed = end;
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
  return {content_->read.get(), content_->read_size};
}

std::string_view InputFile::text() const {
  const auto all = bytes();
  return {reinterpret_cast<const char*>(all.data()), all.size()};
}

std::uint64_t InputFile::checksum() const {
  Content& content = *content_;
  if (content.mapped == nullptr) return xxh3(bytes());
  while (content.summed < content.mapped_size) {
    const std::size_t end = std::min(content.summed + kHashedBytes, content.mapped_size);
    content.sum_up_to(end);
    if (content.mapped_size > kHashedBytes) release_before(end);
  }
  return content.sum->digest();
}

void InputFile::release_before(std::size_t offset) const {
  Content& content = *content_;
  if (content.mapped == nullptr) return;
  const std::size_t end = std::min(offset, content.mapped_size) / kHashedBytes * kHashedBytes;
  // Going back means that the file is read again from the start.
  if (end < content.released) content.released = 0;
  if (end == content.released) return;
  content.sum_up_to(end);
  // The mapping is private and never written, so the pages are read from the file again. If the
  // system does not release them, only memory is lost.
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
    return file_error("file-directory", path, "is a folder, not a file",
                      "specify a file inside it");
  }
  const auto too_large = [&] {
    return file_error("file-too-large", path, fmt::format("is larger than {} bytes", limit));
  };
  // Small files are read: to end a mapping costs every thread of the program up to 0.3 ms.
  constexpr std::uint64_t kMappedFrom = std::uint64_t{1} << 18;
  auto content = std::make_unique<Content>();
  const auto size =
      S_ISREG(status.st_mode) ? static_cast<std::uint64_t>(status.st_size) : std::uint64_t{0};
  if (size > limit) return too_large();
  if (size >= kMappedFrom) {
    void* mapped = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (mapped != MAP_FAILED) {
      content->mapped = mapped;
      content->mapped_size = size;
      return InputFile(path, std::move(content));
    }
  }
  // Memory grows with the data, since a device may never end. No stack buffer: with no memory left,
  // a stack that cannot grow ends the program.
  limit = std::min(limit, InputFile::kStreamLimit);
  std::size_t room = size > 0 && size < kMappedFrom ? size + 1 : kMappedFrom;
  std::size_t& used = content->read_size;
  content->read = std::make_unique_for_overwrite<std::byte[]>(room);
  for (;;) {
    const ssize_t count = ::read(descriptor, content->read.get() + used, room - used);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      return file_error("file-unreadable", path,
                        fmt::format("cannot be read: {}", system_text(errno)));
    }
    if (count == 0) break;
    used += static_cast<std::size_t>(count);
    if (used > limit) return too_large();
    if (used == size) break;  // end of a regular file
    if (used < room) continue;
    room *= 2;
    auto larger = std::make_unique_for_overwrite<std::byte[]>(room);
    std::memcpy(larger.get(), content->read.get(), used);
    content->read = std::move(larger);
  }
  return InputFile(path, std::move(content));
}

}  // namespace krok
