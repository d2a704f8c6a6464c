#pragma once

#include <string>
#include <string_view>

namespace krok {

// Converts a joint name to valid UTF-8 (other text is read as Latin-1) and replaces each
// control character except tab by '_'.
std::string readable_joint_name(std::string_view bytes);

}  // namespace krok
