#pragma once

#include <string_view>

// Private to this folder.

namespace krok::character_file {

inline constexpr std::string_view kSchema = "krok.character/1";

}  // namespace krok::character_file
