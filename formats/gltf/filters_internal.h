#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "math/transform.h"

// Private to the writers: values as the filters of EXT_meshopt_compression store them, which lose
// precision but leave small whole numbers, which compress well. Source: the extension's page,
// appendix B.

namespace krok::gltf {

enum class Filter : unsigned char { none, octahedral, quaternion, exponential };

// OCTAHEDRAL: unit vectors of 8 bits a component; off by less than 1 degree. The fourth number of
// each is +-127 as the sign of w. [vectors x 4]
std::vector<std::int8_t> octahedral(std::span<const Vec4f> vectors);
// As a viewer decodes it, in place.
void decode_octahedral(std::vector<std::int8_t>& numbers);

// QUATERNION: unit quaternions of 4 to 16 bits a component. [rotations x 4]
std::vector<std::int16_t> quaternion(std::span<const Quatf> rotations, int bits);
// What a viewer decodes from it.
std::vector<Quatf> decoded_quaternion(std::span<const Quatf> rotations, int bits);

// EXPONENTIAL: whole steps of 2^exponent, from -24 on; none if a value has more than 23 bits of
// them.
std::optional<std::vector<std::uint32_t>> exponential(std::span<const float> values, int exponent);
// The value nearest to another one.
float in_steps(float value, int exponent);

}  // namespace krok::gltf
