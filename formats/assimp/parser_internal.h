#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/bytes.h"
#include "core/text.h"
#include "nodes/scene.h"

// Private to this folder: parses the child's untrusted output.

namespace krok::assimp {

using nodes::Shared;

// After a failure, reads return empty values, so that one check at the end is enough.
class Parser {
 public:
  explicit Parser(std::span<const std::byte> bytes) : in_(bytes) {}

  bool ok() const { return in_.ok() && fault_.empty(); }
  const std::string& fault() const { return fault_; }
  bool at_end() const { return in_.remaining() == 0; }

  void require(bool holds, const char* what) {
    if (!holds && fault_.empty()) fault_ = what;
  }

  template <typename T>
  T number() {
    return ok() ? in_.read<T>() : T{};
  }

  double finite() {
    const double value = number<double>();
    require(std::isfinite(value), "a number is not finite");
    return value;
  }

  // The number of elements that follow, each at least `bytes_each` long.
  std::size_t count(std::size_t bytes_each) {
    const auto count = number<std::uint64_t>();
    require(count <= in_.remaining() / bytes_each, "a count is larger than the data");
    return ok() ? static_cast<std::size_t>(count) : 0;
  }

  std::string text() {
    const std::size_t size = count(1);
    const std::string_view text = in_.take_text(size);
    return to_utf8(text);
  }

  template <typename T>
  std::vector<T> array() {
    std::vector<T> values(count(sizeof(T)));
    const auto bytes = in_.take(values.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
    return values;
  }

  template <typename T>
  Shared<T> shared() {
    if (number<std::uint8_t>() == 0) return nullptr;
    auto values = std::make_shared<const std::vector<T>>(array<T>());
    const auto* numbers = reinterpret_cast<const float*>(values->data());
    const std::size_t size = values->size() * sizeof(T) / sizeof(float);
    require(std::all_of(numbers, numbers + size, [](float v) { return std::isfinite(v); }),
            "a number is not finite");
    return values;
  }

  Mat4 matrix() {
    Mat4 matrix;
    for (int k = 0; k < 16; ++k) matrix.data()[k] = finite();
    return matrix;
  }

  Vec3 vector() {
    Vec3 vector;
    for (int k = 0; k < 3; ++k) vector[k] = finite();
    return vector;
  }

  Quat unit_quaternion() {
    Quat q;
    for (int k = 0; k < 4; ++k) q.coeffs()[k] = finite();
    require(std::abs(q.norm() - 1.0) < 1e-6, "a rotation is not of length 1");
    return q;
  }

 private:
  ByteReader in_;
  std::string fault_;
};

}  // namespace krok::assimp
