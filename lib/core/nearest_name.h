#pragma once

#include <span>
#include <string>
#include <string_view>

namespace krok {

// The one of `names` that takes the fewest letters put in, left out or exchanged to become `word`,
// case aside; the first of equally near ones. Empty where none is near (more than a third of the
// longer one's letters and two). Names and words are compared up to their first 64 bytes.
std::string nearest_name(std::string_view word, std::span<const std::string> names);

// What to say of a word that is none of `names`: "did you mean 'walk'?" where one is near,
// otherwise "known are walk, run".
std::string nearest_hint(std::string_view word, std::span<const std::string> names);

}  // namespace krok
