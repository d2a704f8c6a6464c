#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/result.h"

// Declares command-line options. CLI11 parses them; only the sources of this folder include its
// large header.

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace krok::cli {

// A kind of value: how its text is read, once for all options of the kind. option_kinds.h has them.
template <typename T>
struct ValueKind {
  std::string name;        // "length", for --list-options
  std::string value_name;  // "LENGTH", in the help, of options that do not name their value
  // The message of an Error names neither option nor value.
  std::function<Result<T>(const std::string& text)> read;
  std::vector<std::string> words;  // that completion offers
};

// A declared option. Conditions on other options are "--other", or "--other WORD" for one value.
struct DeclaredOption {
  CLI::Option* option = nullptr;  // null once it was removed
  std::string kind;
  std::vector<std::string> words;
  // Reads the given texts into the option's variable; may be empty.
  std::function<Status(const std::vector<std::string>& texts)> take;
  std::vector<std::vector<std::string>> only_with;  // one of each list
  std::vector<std::string> not_with;
};

// Handle to a declared option or positional. Cheap to copy; the CommandOptions that created it must
// outlive it. Setters return the option for chaining.
class CommandOption {
 public:
  explicit CommandOption(DeclaredOption* declared) : declared_(declared) {}

  CommandOption type_name(const std::string& name) const;    // value name in the help
  CommandOption default_str(const std::string& text) const;  // default shown in the help
  CommandOption group(const std::string& name) const;        // heading in the help, for this alone
  CommandOption required() const;
  // An error unless one of the conditions is met; a second call adds another list.
  CommandOption only_with(std::vector<std::string> conditions) const;
  CommandOption only_with(const char* condition) const;
  // An error if one of the conditions is met, whichever of the two options says so.
  CommandOption not_with(std::vector<std::string> conditions) const;
  CommandOption not_with(const char* condition) const;
  // For list options: one value per occurrence; the option may be repeated.
  CommandOption one_each_time() const;
  CommandOption delimiter(char between) const;         // between values in one argument
  CommandOption allow_extra_args(bool allowed) const;  // several values per occurrence

 private:
  DeclaredOption* declared_;
};

// What a declared option is, for completion in shells.
struct OptionFacts {
  std::vector<std::string> names;  // "-o", "--output"; none for positionals
  bool positional = false;
  bool takes_value = false;
  std::string value_name;          // "IN.bvh"
  std::vector<std::string> words;  // that the value must be one of; none: any
  std::string description;
  std::string kind;  // "length"
};

class CommandOptions {
 public:
  explicit CommandOptions(CLI::App& app) : app_(app) {}
  CommandOptions(const CommandOptions&) = delete;
  CommandOptions& operator=(const CommandOptions&) = delete;

  // Heading in the help of all options declared after this.
  void group(const std::string& name);
  // CommandOption::only_with() of all options declared after this, up to the next group(); none
  // ends it.
  void only_with(std::vector<std::string> conditions) { only_with_ = std::move(conditions); }

  // Adds an option ("-o,--output OUT", where OUT names its value in the help) or, without dashes, a
  // positional. `value` is unchanged if the option is not given, and must outlive this. Value is
  // what the kind reads, a number, a std::optional of it, or a std::vector of it for an option that
  // is given once for each. `preset` is the default as the user would write it: shown in the help
  // and, if the kind reads it, stored in `value`.
  template <typename Value, typename T>
  CommandOption add(const std::string& name, Value& value, const ValueKind<T>& kind,
                    const std::string& help, const std::string& preset = {}) {
    constexpr bool list = is_list_of<Value, T>();
    constexpr bool maybe = is_optional<Value>() && !std::is_same_v<Value, T>;
    if constexpr (!list && !maybe) {
      if (!preset.empty()) {
        if (auto usual = kind.read(preset)) value = static_cast<Value>(*std::move(usual));
      }
    }
    auto take = [&value, read = kind.read](const std::vector<std::string>& texts) -> Status {
      if constexpr (list) value.clear();
      for (const std::string& text : texts) {
        auto one = read(text);
        if (!one) return std::move(one).error();
        if constexpr (list) {
          value.push_back(*std::move(one));
        } else if constexpr (maybe) {
          value = static_cast<typename Value::value_type>(*std::move(one));
        } else {
          value = static_cast<Value>(*std::move(one));
        }
      }
      return {};
    };
    return add_read(name, list, {nullptr, kind.name, kind.words, std::move(take), {}, {}},
                    kind.value_name, help, preset);
  }
  // The same for text; for a list, several values at a time or one each.
  CommandOption add_option(const std::string& name, std::string& value, const std::string& help);
  CommandOption add_option(const std::string& name, std::vector<std::string>& values,
                           const std::string& help);
  CommandOption add_flag(const std::string& name, bool& value, const std::string& help);
  // A flag that clears `value`: "--no-labels".
  CommandOption add_no_flag(const std::string& name, bool& value, const std::string& help);
  // For a flag with a negated name, "--bones,!--no-bones": `take` gets a positive number for the
  // first.
  CommandOption add_flag_function(const std::string& name, std::function<void(std::int64_t)> take,
                                  const std::string& help);

  // Number of times an option was given.
  std::size_t count(const std::string& name) const;

  // After the command line was parsed: reads all given values. Messages name the option.
  Status take_values() const;
  // What only_with() and not_with() say. Code usage.
  Status check_conditions() const;
  void remove(CLI::Option* option);
  std::vector<OptionFacts> facts() const;

 private:
  template <typename Value, typename T>
  static constexpr bool is_list_of() {
    return std::is_same_v<Value, std::vector<T>>;
  }
  template <typename Value>
  static constexpr bool is_optional() {
    return requires(Value value) {
      value.has_value();
    };
  }
  CommandOption add_read(const std::string& name, bool list, DeclaredOption declared,
                         const std::string& value_name, const std::string& help,
                         const std::string& preset);
  CommandOption declare(CLI::Option* option, DeclaredOption declared);
  bool met(const std::string& condition) const;
  std::string option_that_takes(const CLI::Option& choice) const;  // a hint, or empty

  CLI::App& app_;
  std::deque<DeclaredOption> declared_;
  std::vector<std::string> only_with_;
};

}  // namespace krok::cli
