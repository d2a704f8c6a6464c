#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

// Declares command-line options. CLI11 parses them; only the sources of this folder include its
// large header.

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace krok::cli {

// Validates one option value and may replace it. Returns an error message, empty if valid.
using CheckValue = std::function<std::string(std::string& value)>;

// A CheckValue for a fixed list of words, which completion offers.
struct WordCheck {
  std::vector<std::string> words;
  CheckValue check;
};

// Handle to a declared option or positional. Cheap to copy; the CommandOptions that created it must
// outlive it. Setters return the option for chaining.
class CommandOption {
 public:
  explicit CommandOption(CLI::Option* option) : option_(option) {}

  CommandOption type_name(const std::string& name) const;    // value name in the help
  CommandOption default_str(const std::string& text) const;  // default shown in the help
  CommandOption capture_default_str() const;                 // uses the variable's value
  CommandOption group(const std::string& name) const;        // heading in the help, for this alone
  CommandOption required() const;
  CommandOption needs(const std::string& other) const;  // an error without it
  CommandOption excludes(CommandOption other) const;
  CommandOption check(CheckValue check) const;      // sees the value as written
  CommandOption transform(CheckValue check) const;  // its replacement is parsed
  CommandOption transform(WordCheck check) const;
  // For list options: one value per occurrence; the option may be repeated.
  CommandOption one_each_time() const;
  CommandOption delimiter(char between) const;         // between values in one argument
  CommandOption allow_extra_args(bool allowed) const;  // several values per occurrence

 private:
  CLI::Option* option_;
};

// What a declared option is, for completion in shells.
struct OptionFacts {
  std::vector<std::string> names;  // "-o", "--output"; none for positionals
  bool positional = false;
  bool takes_value = false;
  std::string value_name;          // "IN.bvh"
  std::vector<std::string> words;  // that the value must be one of; none: any
  std::string description;
};
std::vector<OptionFacts> facts_of(const CLI::App& app);

class CommandOptions {
 public:
  explicit CommandOptions(CLI::App& app) : app_(app) {}
  CommandOptions(const CommandOptions&) = delete;
  CommandOptions& operator=(const CommandOptions&) = delete;

  // Heading in the help of all options declared after this.
  void group(const std::string& name);

  // Adds an option ("-o,--output OUT", where OUT names its value in the help) or, without dashes, a
  // positional. `value` is unchanged if the option is not given, and must outlive this. Value is a
  // std::string, a number, a std::optional of one, a std::vector of strings, or an enum with
  // transform(one_of(...)).
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

  // Calls `take` with the given value.
  CommandOption add_option_function(const std::string& name,
                                    std::function<void(const std::string&)> take,
                                    const std::string& help);
  CommandOption add_flag_callback(const std::string& name, std::function<void()> take,
                                  const std::string& help);
  // For a flag with a negated name, "--bones,!--no-bones": `take` gets a positive number for the
  // first.
  CommandOption add_flag_function(const std::string& name, std::function<void(std::int64_t)> take,
                                  const std::string& help);

  // Returns a declared option.
  CommandOption get_option(const std::string& name);
  // Number of times an option was given.
  std::size_t count(const std::string& name) const;

 private:
  template <typename Value>
  CommandOption add_value(const std::string& name, Value& value, const std::string& help);
  CommandOption add_number_function(const std::string& name, std::function<void(std::int64_t)> take,
                                    const std::string& help);

  CLI::App& app_;
};

}  // namespace krok::cli
