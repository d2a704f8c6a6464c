#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "tools/cli/command_options.h"
#include "tools/cli/one_of.h"

// Common kinds of options.

namespace krok::cli {

// `name` with a name for its value, unless it has one: "--rate N".
inline std::string with_value_name(const std::string& name, const char* value) {
  return name.find(' ') == std::string::npos ? name + " " + value : name;
}

// An option with a fixed list of values.
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

// A decimal integer from `low` to `high`. CLI11 itself reads "010" as 8 and "0x10" as 16.
template <typename T>
CommandOption add_whole(CommandOptions& command, const std::string& name, T& value,
                        const std::string& description, long long low, long long high) {
  return command.add_option(with_value_name(name, "N"), value, description)
      .transform([low, high](std::string& text) {
        const auto number = parse_integer(text);
        if (!number || *number < low || *number > high) {
          return "'" + text + "' is not an integer from " + std::to_string(low) + " to " +
                 std::to_string(high);
        }
        text = std::to_string(*number);
        return std::string();
      });
}

// A finite decimal number. CLI11 itself accepts "nan", "0x10" and " 2".
template <typename T>
CommandOption add_number(CommandOptions& command, const std::string& name, T& value,
                         const std::string& description) {
  return command.add_option(with_value_name(name, "N"), value, description)
      .check([](std::string& text) {
        return parse_finite(text) ? std::string() : "'" + text + "' is not a number";
      });
}

// A frame rate in frames per second, from 0.001 to 1000000. CLI11 itself accepts "1e999" and "nan".
template <typename T>
CommandOption add_rate(CommandOptions& command, const std::string& name, T& value,
                       const std::string& description) {
  return command.add_option(with_value_name(name, "N"), value, description)
      .check([](std::string& text) {
        const auto rate = parse_finite(text);
        return rate && *rate >= 1e-3 && *rate <= 1e6
                   ? std::string()
                   : "'" + text + "' is not a frame rate from 0.001 to 1000000";
      });
}

}  // namespace krok::cli
