#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

// What stands between a fuzzer and a reader: checksums, sizes and offsets that must agree.

namespace krok::guided {

// A container (formats/container/SPEC.md) with this magic of the sections that `packed` has: one
// byte of flags, then for each section its name (8 bytes), its size (u16) and as many bytes as
// there are.
std::vector<std::byte> assembled(std::span<const std::byte> packed, std::string_view magic);

// A container so packed. For seeds: sections of up to 65,535 bytes.
std::vector<std::byte> taken_apart(std::span<const std::byte> container);

// A PNG with the checksums of its chunks made right; anything else as it is.
std::vector<std::byte> with_png_checksums(std::span<const std::byte> image);

}  // namespace krok::guided
