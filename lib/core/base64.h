#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace krok {

// Base64 (RFC 4648) with padding. Data encoded in pieces gives the same text as a whole if all
// pieces but the last have a multiple of three bytes.
std::string to_base64(std::span<const std::byte> bytes);

}  // namespace krok
