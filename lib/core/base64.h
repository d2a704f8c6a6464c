#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace krok {

// Bytes as text in base64 (RFC 4648), with its padding. What is encoded in pieces is the same text
// as the whole if all pieces but the last hold a multiple of three bytes.
std::string to_base64(std::span<const std::byte> bytes);

}  // namespace krok
