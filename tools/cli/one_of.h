#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/text.h"
#include "tools/cli/command_options.h"

namespace krok::cli {

// "'dq' is not linear, dual-quaternion or rigid", and which is near.
std::string not_one_of(const std::string& text, const std::vector<std::string>& words);

// For an option with a fixed list of values: add_option(...).transform(one_of(...)). Values are
// case-sensitive; the error message lists them in this order.
template <typename Value>
WordCheck one_of(std::vector<std::pair<std::string, Value>> words) {
  static_assert(std::is_enum_v<Value>);
  std::vector<std::string> names;
  for (const auto& [word, value] : words) names.push_back(word);
  return {names, [words = std::move(words), names](std::string& text) {
            for (const auto& [word, value] : words) {
              if (text != word) continue;
              text = std::to_string(static_cast<std::underlying_type_t<Value>>(value));
              return std::string();
            }
            return not_one_of(text, names);
          }};
}

// The same for an option that stores the word itself; case-insensitive.
inline WordCheck one_of_words(const std::vector<std::string>& words) {
  return {words, [words](std::string& text) {
            for (const std::string& word : words) {
              if (ascii_lower(text) == ascii_lower(word)) return text = word, std::string();
            }
            return not_one_of(text, words);
          }};
}

}  // namespace krok::cli
