#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace krok {

// For an option whose value is one of a list of words: app.add_option(...)->transform(one_of(...)).
// Words are as written here, in this order in the message for any other word. CLI11's own
// transformer takes numbers too and prints its table in the message.
template <typename Value>
CLI::Validator one_of(std::vector<std::pair<std::string, Value>> words) {
  static_assert(std::is_enum_v<Value>);
  return CLI::Validator(
      [words = std::move(words)](std::string& text) {
        std::string list;
        for (const auto& [word, value] : words) {
          if (text == word) {
            text = std::to_string(static_cast<std::underlying_type_t<Value>>(value));
            return std::string();
          }
          list += (list.empty() ? "" : word == words.back().first ? " or " : ", ") + word;
        }
        return "'" + text + "' is not " + list;
      },
      "");
}

}  // namespace krok
