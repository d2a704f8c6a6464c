#include "tools/cli/command_options.h"

#include <CLI/CLI.hpp>
#include <optional>
#include <sstream>
#include <string_view>

#include "core/nearest_name.h"
#include "tools/cli/one_of.h"

namespace krok::cli {

namespace {

// Begins the name of a validator whose rest is the words that it takes.
constexpr std::string_view kWordsMark = "words ";

// No description: CLI11 would print it beside the value name in the help.
CLI::Validator validator(CheckValue check) {
  return CLI::Validator(std::move(check), "");
}

// Splits "--from TIME" into the option's name and that of its value.
template <typename Add>
CommandOption add_named(const std::string& name, Add add) {
  const std::size_t space = name.find(' ');
  CLI::Option* option = add(name.substr(0, space));
  if (space != std::string::npos) option->type_name(name.substr(space + 1));
  return CommandOption(option);
}

}  // namespace

CommandOption CommandOption::type_name(const std::string& name) const {
  option_->type_name(name);
  return *this;
}
CommandOption CommandOption::default_str(const std::string& text) const {
  option_->default_str(text);
  return *this;
}
CommandOption CommandOption::capture_default_str() const {
  option_->capture_default_str();
  return *this;
}
CommandOption CommandOption::group(const std::string& name) const {
  option_->group(name);
  return *this;
}
CommandOption CommandOption::required() const {
  option_->required();
  return *this;
}
CommandOption CommandOption::needs(const std::string& other) const {
  option_->needs(other);
  return *this;
}
CommandOption CommandOption::excludes(CommandOption other) const {
  option_->excludes(other.option_);
  return *this;
}
CommandOption CommandOption::check(CheckValue check) const {
  option_->check(validator(std::move(check)));
  return *this;
}
CommandOption CommandOption::transform(CheckValue check) const {
  option_->transform(validator(std::move(check)));
  return *this;
}
CommandOption CommandOption::transform(WordCheck check) const {
  std::string words;
  for (const std::string& word : check.words) words += (words.empty() ? "" : " ") + word;
  option_->transform(validator(std::move(check.check)).name(std::string(kWordsMark) + words));
  return *this;
}
CommandOption CommandOption::one_each_time() const {
  option_->expected(1)->take_all();
  return *this;
}
CommandOption CommandOption::delimiter(char between) const {
  option_->delimiter(between);
  return *this;
}
CommandOption CommandOption::allow_extra_args(bool allowed) const {
  option_->allow_extra_args(allowed);
  return *this;
}

template <typename Value>
CommandOption CommandOptions::add_value(const std::string& name, Value& value,
                                        const std::string& help) {
  return add_named(name,
                   [&](const std::string& bare) { return app_.add_option(bare, value, help); });
}
template CommandOption CommandOptions::add_value(const std::string&, std::string&,
                                                 const std::string&);
template CommandOption CommandOptions::add_value(const std::string&, std::vector<std::string>&,
                                                 const std::string&);
template CommandOption CommandOptions::add_value(const std::string&, int&, const std::string&);
template CommandOption CommandOptions::add_value(const std::string&, std::int64_t&,
                                                 const std::string&);
template CommandOption CommandOptions::add_value(const std::string&, std::uint64_t&,
                                                 const std::string&);
template CommandOption CommandOptions::add_value(const std::string&, std::uint32_t&,
                                                 const std::string&);
template CommandOption CommandOptions::add_value(const std::string&, double&, const std::string&);
template CommandOption CommandOptions::add_value(const std::string&, std::optional<int>&,
                                                 const std::string&);
template CommandOption CommandOptions::add_value(const std::string&, std::optional<double>&,
                                                 const std::string&);

CommandOption CommandOptions::add_number_function(const std::string& name,
                                                  std::function<void(std::int64_t)> take,
                                                  const std::string& help) {
  return add_named(name, [&](const std::string& bare) {
    return app_.add_option_function<std::int64_t>(
        bare, [take = std::move(take)](const std::int64_t& number) { take(number); }, help);
  });
}

CommandOption CommandOptions::add_flag(const std::string& name, bool& value,
                                       const std::string& help) {
  return CommandOption(app_.add_flag(name, value, help));
}

CommandOption CommandOptions::add_option_function(const std::string& name,
                                                  std::function<void(const std::string&)> take,
                                                  const std::string& help) {
  return add_named(name, [&](const std::string& bare) {
    return app_.add_option_function<std::string>(bare, take, help);
  });
}
CommandOption CommandOptions::add_flag_callback(const std::string& name, std::function<void()> take,
                                                const std::string& help) {
  return CommandOption(app_.add_flag_callback(name, std::move(take), help));
}
CommandOption CommandOptions::add_flag_function(const std::string& name,
                                                std::function<void(std::int64_t)> take,
                                                const std::string& help) {
  return CommandOption(app_.add_flag_function(name, std::move(take), help));
}

void CommandOptions::group(const std::string& name) {
  app_.option_defaults()->group(name);
}

CommandOption CommandOptions::get_option(const std::string& name) {
  return CommandOption(app_.get_option(name));
}
std::size_t CommandOptions::count(const std::string& name) const {
  return app_.count(name);
}
std::string not_one_of(const std::string& text, const std::vector<std::string>& words) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    list += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  }
  const std::string near = nearest_name(text, words);
  return "'" + text + "' is not " + list + (near.empty() ? "" : "; did you mean '" + near + "'?");
}

std::vector<OptionFacts> facts_of(const CLI::App& app) {
  std::vector<OptionFacts> facts;
  for (const CLI::Option* option : app.get_options()) {
    OptionFacts one;
    one.positional = option->get_positional();
    for (const std::string& name : option->get_snames()) one.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) one.names.push_back("--" + name);
    one.takes_value = option->get_items_expected_max() > 0;
    one.value_name = option->get_type_name();
    one.description = option->get_description();
    // The validators of an option are found by number until there is none.
    try {
      for (int i = 0;; ++i) {
        const std::string& name = const_cast<CLI::Option*>(option)->get_validator(i)->get_name();
        if (name.rfind(kWordsMark, 0) != 0) continue;
        std::istringstream words(name.substr(kWordsMark.size()));
        for (std::string word; words >> word;) one.words.push_back(word);
      }
    } catch (const CLI::OptionNotFound&) {
    }
    facts.push_back(std::move(one));
  }
  return facts;
}

}  // namespace krok::cli
