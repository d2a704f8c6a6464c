#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/text.h"
#include "tools/common/command_options.h"

namespace krok {

// For an option whose value is one of a list of words: add_option(...).transform(one_of(...)).
// Words are as written here, in this order in the message for any other word.
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

// The same for an option that keeps the word itself; letters in either case are the same.
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

}  // namespace krok
