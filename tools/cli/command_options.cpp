#include "tools/cli/command_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "tools/cli/option_kinds.h"
#include "tools/cli/usage.h"

namespace krok::cli {

namespace {

// Splits "--from TIME" into the option's name and that of its value.
template <typename Add>
CLI::Option* add_named(const std::string& name, Add add) {
  const std::size_t space = name.find(' ');
  CLI::Option* option = add(name.substr(0, space));
  if (space != std::string::npos) option->type_name(name.substr(space + 1));
  return option;
}

// "--from" or, of a positional, "input".
std::string name_of(const CLI::Option& option) {
  return (option.get_positional() ? "" : "--") + option.get_single_name();
}

bool is_given(const CLI::Option& option) {
  if (option.count() == 0) return false;
  bool on = true;  // a flag may be off
  if (option.get_items_expected_max() == 0) {
    (void)CLI::detail::lexical_cast(option.results().back(), on);
  }
  return on;
}

// Decimal commas as points, of lists with commas each second one: "0,5m,1,5m". Who writes a point
// somewhere, or an even number of commas between values, means none.
std::vector<std::string> with_points(std::vector<std::string> texts, int every) {
  for (std::string& text : texts) {
    const bool odd = std::ranges::count(text, ',') % 2 == 1;
    if (text.find('.') != std::string::npos || (every > 1 && !odd)) continue;
    int commas = 0;
    for (char& c : text) {
      if (c == ',' && commas++ % every == 0) c = '.';
    }
  }
  return texts;
}

// Text alone has no kind but what its name in the help says.
std::string kind_of_text(const CLI::Option& option) {
  const std::string& value = option.get_type_name();
  return value.starts_with("IN")    ? "input"
         : value.starts_with("OUT") ? "output"
         : value == "DIR"           ? "folder"
                                    : "text";
}

}  // namespace

CommandOption CommandOption::type_name(const std::string& name) const {
  declared_->option->type_name(name);
  return *this;
}
CommandOption CommandOption::default_str(const std::string& text) const {
  declared_->option->default_str(text);
  return *this;
}
CommandOption CommandOption::group(const std::string& name) const {
  declared_->option->group(name);
  return *this;
}
CommandOption CommandOption::required() const {
  declared_->option->required();
  return *this;
}
CommandOption CommandOption::only_with(std::vector<std::string> conditions) const {
  declared_->only_with.push_back(std::move(conditions));
  return *this;
}
CommandOption CommandOption::only_with(const char* condition) const {
  return only_with(std::vector<std::string>{condition});
}
CommandOption CommandOption::not_with(std::vector<std::string> conditions) const {
  declared_->not_with.insert(declared_->not_with.end(), conditions.begin(), conditions.end());
  return *this;
}
CommandOption CommandOption::not_with(const char* condition) const {
  return not_with(std::vector<std::string>{condition});
}
CommandOption CommandOption::one_each_time() const {
  declared_->option->expected(1)->take_all();
  return *this;
}
CommandOption CommandOption::delimiter(char between) const {
  declared_->option->delimiter(between);
  return *this;
}
CommandOption CommandOption::allow_extra_args(bool allowed) const {
  declared_->option->allow_extra_args(allowed);
  return *this;
}

CommandOption CommandOptions::declare(CLI::Option* option, DeclaredOption declared) {
  declared.option = option;
  if (!only_with_.empty()) declared.only_with.push_back(only_with_);
  return CommandOption(&declared_.emplace_back(std::move(declared)));
}

CommandOption CommandOptions::add_option(const std::string& name, std::string& value,
                                         const std::string& help) {
  return declare(
      add_named(name, [&](const auto& bare) { return app_.add_option(bare, value, help); }), {});
}
CommandOption CommandOptions::add_option(const std::string& name, std::vector<std::string>& values,
                                         const std::string& help) {
  return declare(
      add_named(name, [&](const auto& bare) { return app_.add_option(bare, values, help); }), {});
}

CommandOption CommandOptions::add_read(const std::string& name, bool list, DeclaredOption declared,
                                       const std::string& value_name, const std::string& help,
                                       const std::string& preset) {
  const bool named = name.find(' ') != std::string::npos;
  // The values are read by take_values().
  CLI::Option* option =
      add_named(named ? name : name + " " + value_name, [&](const std::string& bare) {
        using Texts = std::vector<std::string>;
        return list ? app_.add_option_function<Texts>(
                          bare, [](const Texts&) {}, help)
                    : app_.add_option_function<std::string>(
                          bare, [](const std::string&) {}, help);
      });
  if (list && !option->get_positional()) option->expected(1)->take_all();
  if (!preset.empty()) option->default_str(preset);
  return declare(option, std::move(declared));
}

CommandOption CommandOptions::add_flag(const std::string& name, bool& value,
                                       const std::string& help) {
  return declare(app_.add_flag(name, value, help), {});
}
CommandOption CommandOptions::add_no_flag(const std::string& name, bool& value,
                                          const std::string& help) {
  return add_flag_function(
      name, [&value](std::int64_t sign) { value = sign <= 0; }, help);
}
CommandOption CommandOptions::add_flag_function(const std::string& name,
                                                std::function<void(std::int64_t)> take,
                                                const std::string& help) {
  return declare(app_.add_flag_function(name, std::move(take), help), {});
}

void CommandOptions::group(const std::string& name) {
  app_.option_defaults()->group(name);
  only_with_.clear();
}
std::size_t CommandOptions::count(const std::string& name) const {
  return app_.count(name);
}

void CommandOptions::remove(CLI::Option* option) {
  for (DeclaredOption& declared : declared_) {
    if (declared.option == option) declared.option = nullptr;
  }
  app_.remove_option(option);
}

Status CommandOptions::take_values() const {
  for (const DeclaredOption& declared : declared_) {
    if (declared.option == nullptr || declared.option->count() == 0 || !declared.take) continue;
    Status status = declared.take(declared.option->results());
    if (status) continue;
    Error error = std::move(status).error();
    error.message = fmt::format("{}: {}", name_of(*declared.option), error.message);
    const CLI::Option& option = *declared.option;
    for (const int every : {1, 2}) {
      const auto texts = with_points(option.results(), every);
      if (texts == option.results() || !declared.take(texts)) continue;
      error.hint = fmt::format("write {}: decimals have a point", texts.back());
    }
    if (declared.kind == "choice") {
      if (std::string other = option_that_takes(option); !other.empty()) {
        error.hint = std::move(other);
      }
    }
    if (error.hint.empty()) {
      if (declared.kind == "list") error.hint = fmt::format("write {}: ", option.get_type_name());
      error.hint += option.get_description();
    }
    return error;
  }
  return {};
}

// "--filter 6", where --cutoff 6 goes with --filter butterworth.
std::string CommandOptions::option_that_takes(const CLI::Option& choice) const {
  const std::string name = name_of(choice);
  std::string text = choice.results().back();
  text.erase(0, text.find_last_of(",:=") + 1);  // "butterworth,6"
  if (text.find_first_of("0123456789") == std::string::npos) return {};
  for (const DeclaredOption& other : declared_) {
    if (other.option == nullptr || !other.take || other.kind == "choice") continue;
    if (other.option->get_positional()) continue;
    for (const std::vector<std::string>& conditions : other.only_with) {
      for (const std::string& condition : conditions) {
        if (!condition.starts_with(name + " ") || !other.take({text})) continue;
        return fmt::format("write {} {} {}", condition, name_of(*other.option), text);
      }
    }
  }
  return {};
}

bool CommandOptions::met(const std::string& condition) const {
  const std::size_t space = condition.find(' ');
  const CLI::Option* other = app_.get_option_no_throw(condition.substr(0, space));
  if (other == nullptr) return false;
  if (space == std::string::npos) return is_given(*other);
  const std::string& value =
      other->count() > 0 ? other->results().back() : other->get_default_str();
  return value == condition.substr(space + 1);
}

Status CommandOptions::check_conditions() const {
  for (const DeclaredOption& declared : declared_) {
    if (declared.option == nullptr || !is_given(*declared.option)) continue;
    const std::string name = name_of(*declared.option);
    const auto is_met = [this](const std::string& condition) { return met(condition); };
    for (const std::vector<std::string>& of : declared.only_with) {
      if (std::ranges::any_of(of, is_met)) continue;
      std::vector<std::string> words = of;  // "action pack", of a positional, is told as "pack"
      for (std::string& word : words) {
        if (!word.starts_with('-')) word.erase(0, word.find(' ') + 1);
      }
      const std::string others = either_of(words);
      return usage(fmt::format("{} is for {}", name, others),
                   fmt::format("add {}, or leave {} out", others, name));
    }
    const auto other = std::ranges::find_if(declared.not_with, is_met);
    if (other == declared.not_with.end()) continue;
    return usage(fmt::format("{} and {} exclude each other", *other, name),
                 "leave one of them out");
  }
  return {};
}

std::vector<OptionFacts> CommandOptions::facts() const {
  std::vector<OptionFacts> facts;
  for (const CLI::Option* option : std::as_const(app_).get_options()) {
    OptionFacts one;
    one.positional = option->get_positional();
    for (const std::string& name : option->get_snames()) one.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) one.names.push_back("--" + name);
    one.takes_value = option->get_items_expected_max() > 0;
    one.value_name = option->get_type_name();
    one.description = option->get_description();
    one.kind = one.takes_value ? kind_of_text(*option) : "flag";
    const auto declared = std::ranges::find(declared_, option, &DeclaredOption::option);
    if (declared != declared_.end() && !declared->kind.empty()) {
      one.kind = declared->kind;
      one.words = declared->words;
    }
    facts.push_back(std::move(one));
  }
  return facts;
}

}  // namespace krok::cli
