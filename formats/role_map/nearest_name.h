#pragma once

#include <span>
#include <string>
#include <string_view>

namespace krok::role_map {

// The one of `names` that takes the fewest letters put in, left out or exchanged to become `word`,
// case aside; the first of equally near ones. Empty where none is near (more than a third of the
// longer one's letters and two). Names and words are compared up to their first 64 bytes.
std::string nearest_name(std::string_view word, std::span<const std::string> names);

}  // namespace krok::role_map
