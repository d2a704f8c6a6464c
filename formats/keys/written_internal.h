#pragma once

#include <string>

#include "formats/keys/keys.h"

// Shared by reader and writer: number formatting and the checksum.

namespace krok::keys {

inline constexpr std::string_view kSchema = "krok.keys/1";

std::string written_time(double seconds);
std::string written_place(const Vec3& place);  // "[x, y, z]"

bool by_hand(const std::vector<std::uint8_t>& marks, std::size_t index);

// The XXH3 checksum, as 16 hexadecimal digits, of all entries not marked as set by hand: one line
// each, "contact NAME START END [x, y, z]" and "keytime NAME TIME", as written, ending with LF.
std::string checksum(const Sidecar& sidecar, const Skeleton& skeleton);

}  // namespace krok::keys
