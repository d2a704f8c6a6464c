#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "math/transform.h"

// Bytes of binary files, written one after the other.

namespace krok::test {

class BinaryText {
 public:
  template <typename T>
  BinaryText& put(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  BinaryText& text(std::string_view text, std::size_t size) {
    std::string fixed(text);
    fixed.resize(size);
    bytes_ += fixed;
    return *this;
  }
  BinaryText& vector(const Vec3& v) {
    for (int k = 0; k < 3; ++k) put(static_cast<float>(v[k]));
    return *this;
  }
  BinaryText& append(const std::string& bytes) {
    bytes_ += bytes;
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace krok::test
