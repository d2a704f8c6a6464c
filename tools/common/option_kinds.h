#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "tools/common/command_options.h"
#include "tools/common/one_of.h"

// Kinds of options that several tools have.

namespace krok {

// An option whose value is one of a list of words.
template <typename T>
CommandOption add_choice(CommandOptions& command, const std::string& name, T& value,
                         std::vector<std::pair<std::string, T>> words,
                         const std::string& description, const std::string& type_name,
                         const std::string& default_word) {
  return command.add_option(name, value, description)
      .type_name(type_name)
      .transform(one_of(std::move(words)))
      .default_str(default_word);
}

// A whole decimal number from `low` to `high`. CLI11 alone takes "010" for 8 and "0x10" for 16.
template <typename T>
CommandOption add_whole(CommandOptions& command, const std::string& name, T& value,
                        const std::string& description, long long low, long long high) {
  return command.add_option(name, value, description)
      .type_name("N")
      .transform([low, high](std::string& text) {
        const auto number = parse_integer(text);
        if (!number || *number < low || *number > high) {
          return "'" + text + "' is no whole number from " + std::to_string(low) + " to " +
                 std::to_string(high);
        }
        text = std::to_string(*number);
        return std::string();
      });
}

// A finite decimal number. CLI11 alone takes "nan", "0x10" and " 2".
template <typename T>
CommandOption add_number(CommandOptions& command, const std::string& name, T& value,
                         const std::string& description) {
  return command.add_option(name, value, description).type_name("N").check([](std::string& text) {
    return parse_finite(text) ? std::string() : "'" + text + "' is no number";
  });
}

// Frames a second: a positive finite number; CLI11 alone takes "1e999" and "nan".
template <typename T>
CommandOption add_rate(CommandOptions& command, const std::string& name, T& value,
                       const std::string& description) {
  return command.add_option(name, value, description).type_name("N").check([](std::string& text) {
    const auto rate = parse_finite(text);
    return rate && *rate >= 1e-3 && *rate <= 1e6
               ? std::string()
               : "'" + text + "' is no rate from 0.001 to 1000000";
  });
}

}  // namespace krok
