#pragma once

#include <span>
#include <string>
#include <string_view>

namespace krok {

// The one of `names` with the smallest edit distance (Levenshtein, with exchanged letters as one
// edit) to `word`, ignoring case; the first of equally near ones. Empty if none is near, that is
// within the larger of two letters and a third of the longer word, and one letter or less than half
// of it (without dashes before it). Only the first 64 bytes are compared.
std::string nearest_name(std::string_view word, std::span<const std::string> names);

// A hint for a word that is not in `names`: "did you mean 'walk'?" if one is near, otherwise
// "expected one of walk, run".
std::string nearest_hint(std::string_view word, std::span<const std::string> names);

}  // namespace krok
