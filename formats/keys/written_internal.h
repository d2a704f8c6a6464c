#pragma once

#include <string>

#include "formats/keys/keys.h"

// What reader and writer share: numbers as they are written, and the checksum over them.

namespace krok::keys {

inline constexpr std::string_view kSchema = "krok.keys/1";

std::string written_time(double seconds);
std::string written_place(const Vec3& place);  // "[x, y, z]"

bool by_hand(const std::vector<std::uint8_t>& marks, std::size_t index);

// The XXH3 checksum, as 16 digits, of everything that is not marked as set by hand: a line each,
// "contact NAME START END [x, y, z]" and "keytime NAME TIME", as written, ending with LF.
std::string checksum(const Sidecar& sidecar, const Skeleton& skeleton);

}  // namespace krok::keys
