#include <meshoptimizer.h>

#include <cmath>

#include "formats/gltf/filters_internal.h"

namespace krok::gltf {

namespace {

constexpr double kLargestMantissa = (1 << 23) - 1;

}  // namespace

std::vector<std::int8_t> octahedral(std::span<const Vec4f> vectors) {
  std::vector<std::int8_t> numbers(4 * vectors.size());
  std::vector<Vec4f> signs(vectors.begin(), vectors.end());
  for (Vec4f& vector : signs) vector.w() = vector.w() < 0 ? -1.0f : 1.0f;
  meshopt_encodeFilterOct(numbers.data(), signs.size(), 4, 8, signs.data()->data());
  return numbers;
}

void decode_octahedral(std::vector<std::int8_t>& numbers) {
  meshopt_decodeFilterOct(numbers.data(), numbers.size() / 4, 4);
}

std::vector<std::int16_t> quaternion(std::span<const Quatf> rotations, int bits) {
  std::vector<std::int16_t> numbers(4 * rotations.size());
  std::vector<Quatf> unit(rotations.begin(), rotations.end());
  for (Quatf& rotation : unit) rotation.normalize();
  meshopt_encodeFilterQuat(numbers.data(), unit.size(), 8, bits, unit.data()->coeffs().data());
  return numbers;
}

std::vector<Quatf> decoded_quaternion(std::span<const Quatf> rotations, int bits) {
  std::vector<std::int16_t> numbers = quaternion(rotations, bits);
  meshopt_decodeFilterQuat(numbers.data(), rotations.size(), 8);
  std::vector<Quatf> decoded;
  for (std::size_t i = 0; i < numbers.size(); i += 4) {
    Quatf& rotation = decoded.emplace_back();
    for (int c = 0; c < 4; ++c) {
      rotation.coeffs()[c] = static_cast<float>(numbers[i + static_cast<std::size_t>(c)]) / 32767;
    }
    rotation.normalize();
  }
  return decoded;
}

std::optional<std::vector<std::uint32_t>> exponential(std::span<const float> values, int exponent) {
  std::vector<std::uint32_t> numbers;
  for (const float value : values) {
    const double steps = std::round(std::ldexp(static_cast<double>(value), -exponent));
    if (!(std::abs(steps) <= kLargestMantissa)) return std::nullopt;
    const auto mantissa = static_cast<std::uint32_t>(static_cast<std::int32_t>(steps));
    numbers.push_back(static_cast<std::uint32_t>(exponent) << 24 | (mantissa & 0xFFFFFFu));
  }
  return numbers;
}

float in_steps(float value, int exponent) {
  return static_cast<float>(
      std::ldexp(std::round(std::ldexp(static_cast<double>(value), -exponent)), exponent));
}

}  // namespace krok::gltf
