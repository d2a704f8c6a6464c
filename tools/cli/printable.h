#pragma once

#include <string>

namespace krok::cli {

// Replaces control characters in UTF-8 `text` by "?". Names in files may contain terminal escape
// sequences.
std::string printable(const std::string& text);

}  // namespace krok::cli
