#pragma once

#include <string>

namespace krok {

// JSON text with what printable() replaces (core/text.h) as escape sequences, so that its strings
// are the same. JSON has these characters in strings alone, and none below U+0020.
std::string with_escaped_controls(const std::string& json);

}  // namespace krok
