#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/text.h"
#include "tools/cli/command_options.h"

namespace krok::cli {

// For an option with a fixed list of values: add_option(...).transform(one_of(...)). Values are
// case-sensitive; the error message lists them in this order.
template <typename Value>
CheckValue one_of(std::vector<std::pair<std::string, Value>> words) {
  static_assert(std::is_enum_v<Value>);
  return [words = std::move(words)](std::string& text) {
    std::string list;
    for (const auto& [word, value] : words) {
      if (text == word) {
        text = std::to_string(static_cast<std::underlying_type_t<Value>>(value));
        return std::string();
      }
      list += (list.empty() ? "" : word == words.back().first ? " or " : ", ") + word;
    }
    return "'" + text + "' is not " + list;
  };
}

// The same for an option that stores the word itself; case-insensitive.
inline CheckValue one_of_words(std::vector<std::string> words) {
  return [words = std::move(words)](std::string& text) {
    std::string list;
    for (const std::string& word : words) {
      if (ascii_lower(text) == ascii_lower(word)) return text = word, std::string();
      list += (list.empty() ? "" : word == words.back() ? " or " : ", ") + word;
    }
    return "'" + text + "' is not " + list;
  };
}

}  // namespace krok::cli
