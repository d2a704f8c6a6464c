#include <algorithm>
#include <cstring>
#include <limits>

#include "core/text.h"
#include "formats/assimp/memory_files_internal.h"

namespace krok::assimp {

namespace {

class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::span<const std::byte> bytes) : bytes_(bytes) {}

  size_t Read(void* buffer, size_t size, size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - position_) / size);
    if (whole == 0) return 0;
    std::memcpy(buffer, bytes_.data() + position_, whole * size);
    position_ += whole * size;
    return whole;
  }

  size_t Write(const void*, size_t, size_t) override { return 0; }

  aiReturn Seek(size_t offset, aiOrigin origin) override {
    std::size_t position = offset;
    if (origin == aiOrigin_CUR) position = position_ + offset;
    if (origin == aiOrigin_END) position = bytes_.size() - offset;
    if (position > bytes_.size()) return aiReturn_FAILURE;
    position_ = position;
    return aiReturn_SUCCESS;
  }

  size_t Tell() const override { return position_; }
  size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

}  // namespace

const MemoryFile* MemoryFiles::find(const char* path) const {
  std::string_view name = path;
  name.remove_prefix(name.find_last_of("/\\") + 1);  // npos + 1 is 0
  for (const MemoryFile& file : files_) {
    if (same_word(file.name, name)) return &file;
  }
  return nullptr;
}

bool MemoryFiles::Exists(const char* path) const {
  return find(path) != nullptr;
}

Assimp::IOStream* MemoryFiles::Open(const char* path, const char* mode) {
  if (std::strchr(mode, 'r') == nullptr || std::strchr(mode, '+') != nullptr) return nullptr;
  const MemoryFile* file = find(path);
  return file == nullptr ? nullptr : new MemoryStream(file->bytes);
}

void MemoryFiles::Close(Assimp::IOStream* stream) {
  delete stream;
}

}  // namespace krok::assimp
