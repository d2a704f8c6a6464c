#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// Bounds-checked reader and growing writer for little-endian binary data. Krok builds only on
// little-endian machines (checked below), so values are copied without conversion.

namespace krok {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the binary formats are little-endian");

// Reads from a span that it does not own. A read past the end returns zeros, moves to the end and
// clears ok() for good, so that a series of reads needs one check.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> data) : data_(data) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T> T read() {
    T value{};
    const auto bytes = take(sizeof(T));
    if (!bytes.empty()) std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }

  // The next `count` bytes, or an empty span (and ok() false) if fewer are left.
  std::span<const std::byte> take(std::size_t count) {
    if (count > remaining()) {
      ok_ = false;
      position_ = data_.size();
      return {};
    }
    const auto part = data_.subspan(position_, count);
    position_ += count;
    return part;
  }

  std::string_view take_text(std::size_t count) {
    const auto part = take(count);
    return {reinterpret_cast<const char*>(part.data()), part.size()};
  }

  void seek(std::size_t position) {
    ok_ = ok_ && position <= data_.size();
    position_ = position <= data_.size() ? position : data_.size();
  }

  bool ok() const { return ok_; }
  std::size_t position() const { return position_; }
  std::size_t remaining() const { return data_.size() - position_; }

 private:
  std::span<const std::byte> data_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

// Appends to a buffer that it owns.
class ByteWriter {
 public:
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void write(const T& value) { append(std::as_bytes(std::span(&value, 1))); }

  void append(std::span<const std::byte> bytes) {
    data_.insert(data_.end(), bytes.begin(), bytes.end());
  }

  void append_text(std::string_view text) { append(std::as_bytes(std::span(text))); }

  // Pads with zeros to the next multiple of `alignment`.
  void align(std::size_t alignment) {
    const std::size_t over = data_.size() % alignment;
    if (over != 0) data_.resize(data_.size() + alignment - over, std::byte{0});
  }

  std::size_t size() const { return data_.size(); }
  std::span<const std::byte> bytes() const { return data_; }
  std::vector<std::byte>& buffer() { return data_; }

 private:
  std::vector<std::byte> data_;
};

}  // namespace krok
