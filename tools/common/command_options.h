#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

// The options of a command line as tools declare them. CLI11 parses them; its header is large and
// is included by the sources of this folder alone.

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace krok {

// Looks at one value of an option and may replace it; gives what is wrong with it, or nothing.
using CheckValue = std::function<std::string(std::string& value)>;

// An option or positional that was declared. A handle, cheap to copy; the CommandOptions that gave
// it must outlive it. The setters give the option back, so that calls can be chained.
class CommandOption {
 public:
  explicit CommandOption(CLI::Option* option) : option_(option) {}

  CommandOption type_name(const std::string& name) const;    // of its value in the help
  CommandOption default_str(const std::string& text) const;  // the default that the help names
  CommandOption capture_default_str() const;                 // the variable's own value as that
  CommandOption group(const std::string& name) const;        // its heading in the help
  CommandOption required() const;
  CommandOption needs(const std::string& other) const;  // given alone it is an error
  CommandOption excludes(CommandOption other) const;
  CommandOption check(CheckValue check) const;      // as the user wrote the value
  CommandOption transform(CheckValue check) const;  // the same; its replacement is what is parsed
  // Of an option with a list: one value each time that it is given, and it may be given again.
  CommandOption one_each_time() const;
  CommandOption delimiter(char between) const;         // that separates values in one argument
  CommandOption allow_extra_args(bool allowed) const;  // more than one value at a time

 private:
  CLI::Option* option_;
};

class CommandOptions {
 public:
  explicit CommandOptions(CLI::App& app) : app_(app) {}
  CommandOptions(const CommandOptions&) = delete;
  CommandOptions& operator=(const CommandOptions&) = delete;

  // An option ("-o,--output") or, without dashes, a positional; `value` keeps what it had where the
  // option is not given, and must outlive this. Value is a std::string, a number, a std::optional
  // of one, a std::vector of strings, or an enum, whose words transform(one_of(...)) gives.
  template <typename Value>
  CommandOption add_option(const std::string& name, Value& value, const std::string& help) {
    if constexpr (std::is_enum_v<Value>) {
      return add_number_function(
          name, [&value](std::int64_t number) { value = static_cast<Value>(number); }, help);
    } else {
      return add_value(name, value, help);
    }
  }
  CommandOption add_flag(const std::string& name, bool& value, const std::string& help);

  // The same with a function that is called with what was given.
  CommandOption add_option_function(const std::string& name,
                                    std::function<void(const std::string&)> take,
                                    const std::string& help);
  CommandOption add_flag_callback(const std::string& name, std::function<void()> take,
                                  const std::string& help);
  // For a flag with two names, "--bones,!--no-bones": positive for the first.
  CommandOption add_flag_function(const std::string& name, std::function<void(std::int64_t)> take,
                                  const std::string& help);

  // One that was declared before.
  CommandOption get_option(const std::string& name);
  // How often an option was given.
  std::size_t count(const std::string& name) const;
  // Puts the options that have no group of their own, without the positionals, into one.
  void group_remaining(const std::string& name);

 private:
  template <typename Value>
  CommandOption add_value(const std::string& name, Value& value, const std::string& help);
  CommandOption add_number_function(const std::string& name, std::function<void(std::int64_t)> take,
                                    const std::string& help);

  CLI::App& app_;
};

}  // namespace krok
