#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "tools/cli/command_line.h"
#include "tools/cli/option_search.h"
#include "tools/cli/renamed_options.h"
#include "tools/cli/usage.h"

// What is wrong with arguments that cannot be parsed, and what was probably meant.

namespace krok::cli {

namespace {

// "'a' 'b'", of at most three.
std::string shown_list(const std::vector<std::string>& words) {
  std::string list;
  for (std::size_t i = 0; i < words.size() && i < 3; ++i) {
    list += fmt::format("{}'{}'", i == 0 ? "" : " ", shown(words[i]));
  }
  return list + (words.size() > 3 ? " ..." : "");
}

}  // namespace

// "--match-heights" where there are --height and --match-height: up to three with a word of it.
std::string CommandLine::options_like(const std::string& name) const {
  std::vector<ToolOption> options;
  if (spec_.options_of_all) {
    options = spec_.options_of_all();
  } else {
    for (OptionFacts& facts : options_.facts()) options.push_back({spec_.name, std::move(facts)});
  }
  std::vector<std::string> hints;
  for (const ToolOption& one : options_about(name, spec_.name, options, 3)) {
    hints.push_back(fmt::format("{} has {}", one.tool, shown_option(one.facts)));
  }
  return fmt::format("{}", fmt::join(hints, "; "));
}

std::string CommandLine::names_of_own_options() const {
  std::vector<std::string> names;
  for (const CLI::Option* option : own_options_) {
    if (!option->get_positional()) names.push_back(option->get_name());
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

// "--json report.json", where a space makes the file an input; "--json" came as "--json=-".
std::optional<Error> CommandLine::json_file_apart(const std::vector<std::string>& arguments) const {
  const auto at = std::ranges::find(arguments, "--json=-");
  if (at == arguments.end() || std::next(at) == arguments.end()) return std::nullopt;
  const std::string& file = *std::next(at);
  if (extension(file) != ".json" || std::filesystem::exists(file)) return std::nullopt;
  return usage(fmt::format("--json writes to standard output, and {} is an input that is missing",
                           shown(file)),
               fmt::format("write --json={}", file));
}

// The first option whose value would be the option after it: "--size -o x.png".
std::optional<Error> CommandLine::option_without_value(
    const std::vector<std::string>& arguments) const {
  for (std::size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
    const bool last = i + 1 == arguments.size();
    const std::string next = last ? std::string() : arguments[i + 1];
    if (!arguments[i].starts_with('-') || !(last || next.starts_with('-')) || next == "-") continue;
    const CLI::Option* option = app_.get_option_no_throw(arguments[i]);
    if (option == nullptr || option->get_items_expected_min() < 1) continue;
    // "--fix -o fixed", of a tool without -o.
    const bool is_option = last || next == "-o" || (next.starts_with("--") && next.size() > 2) ||
                           app_.get_option_no_throw(next.substr(0, next.find('='))) != nullptr;
    if (!is_option) continue;
    return usage(fmt::format("{} has no value", arguments[i]),
                 fmt::format("write {} {}{}", arguments[i], option->get_type_name(),
                             last ? "" : fmt::format("; '{}' is the next option", next)));
  }
  return std::nullopt;
}

// "-json" would be -j with the value "son"; "-x" is none where there is --x.
std::optional<Error> CommandLine::option_with_one_dash(
    const std::vector<std::string>& arguments) const {
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    if (argument.size() < 2 || argument[0] != '-' || argument[1] == '-') continue;
    const std::string name = "-" + argument.substr(0, argument.find('='));
    if (app_.get_option_no_throw(name) == nullptr || app_.get_option_no_throw(argument)) continue;
    return usage(fmt::format("unknown option '{}'", name.substr(1)),
                 fmt::format("did you mean '{}'?", name));
  }
  return std::nullopt;
}

// A word that looks like an option and is none.
std::optional<Error> CommandLine::unknown_option(const std::string& argument) const {
  std::vector<std::string> names;
  for (const OptionFacts& option : options_.facts()) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  const bool is_long = argument.starts_with("--");
  const bool letter = argument.size() >= 2 && argument[0] == '-' &&
                      std::isalpha(static_cast<unsigned char>(argument[1])) != 0;
  if (!is_long && !letter) return std::nullopt;
  const std::string name = argument.substr(0, argument.find('='));
  if (app_.get_option_no_throw(is_long ? name : name.substr(0, 2)) != nullptr) {
    return std::nullopt;
  }
  std::string dashed = name;  // as options are written here: --frame-rate for --frame_rate
  std::ranges::replace(dashed, '_', '-');
  const auto has = [&](const std::string& option) {
    return app_.get_option_no_throw(option) != nullptr;
  };
  if (const RenamedOption* row = renamed_option(spec_.name, dashed, has)) {
    return usage(fmt::format("unknown option '{}'", name), fmt::format("use {}", row->now));
  }
  // "--dual-quaternion" is a value of --method.
  for (const OptionFacts& option : options_.facts()) {
    if (!is_long || option.positional || !std::ranges::count(option.words, dashed.substr(2))) {
      continue;
    }
    return usage(fmt::format("unknown option '{}'", name),
                 fmt::format("use {} {}", option.names.back(), dashed.substr(2)));
  }
  std::vector<std::string> hints;
  if (is_long && spec_.options_of_all) {
    auto options = spec_.options_of_all();
    std::erase_if(options, [&](const ToolOption& one) {
      return std::ranges::find(one.facts.names, dashed) == one.facts.names.end();
    });
    // Of a word with many uses it says nothing.
    if (options.size() > 2) options.clear();
    for (const ToolOption& one : options) {
      hints.push_back(
          one.tool == "krok-retarget" && has("--retarget")
              ? "krok-retarget IN --onto CHARACTER -o OUT.anim has it; its motion "
                "needs no --retarget here"
              : fmt::format("{} has it: {}", one.tool, first_sentence(one.facts.description)));
    }
  }
  if (is_long && hints.empty()) {
    for (const RenamedOption& row : kRenamedOptions) {
      if (!row.was(dashed) || row.tool.empty() || !row.now.starts_with("--")) continue;
      hints.push_back(fmt::format("{} has {}", row.tool, row.now));
      break;
    }
  }
  const std::string near =
      name.size() > 2 ? nearest_name(is_long ? dashed : "-" + dashed, names) : std::string();
  if (!near.empty()) hints.push_back(fmt::format("did you mean '{}'?", near));
  if (near.empty() && is_long) {
    const std::string like = options_like(dashed);
    if (!like.empty()) hints.push_back(like);
  }
  if (hints.empty()) hints.push_back(fmt::format("{} has {}", spec_.name, names_of_own_options()));
  if (near.empty()) hints.push_back(fmt::format("see {} --help", spec_.name));
  return Error("usage", fmt::format("unknown option '{}'", shown(name)),
               fmt::format("{}", fmt::join(hints, "; ")));
}

// All words before "--" that look like options and are none, each with its hint.
std::optional<Error> CommandLine::unknown_options(const std::vector<std::string>& arguments) const {
  std::optional<Error> all;
  std::vector<std::string> seen;
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    const std::string name = argument.substr(0, argument.find('='));
    auto one = unknown_option(argument);
    if (!one || std::ranges::find(seen, name) != seen.end()) continue;
    seen.push_back(name);
    if (!all) {
      all = *std::move(one);
    } else {
      if (seen.size() == 2) {
        all->message.insert(std::string_view("unknown option").size(), "s");
        all->hint = seen.front() + ": " + all->hint;
      }
      all->message += fmt::format(" and '{}'", shown(name));
      all->hint += fmt::format("; {}: {}", shown(name), one->hint);
    }
  }
  return all;
}

// "--mirror x": a word, and no file, after an option that takes none.
std::optional<Error> CommandLine::value_of_flag(const std::vector<std::string>& arguments,
                                                const std::string& word) const {
  const auto at = std::find(arguments.begin(), arguments.end(), word);
  if (at == arguments.begin() || at == arguments.end() || !extension(word).empty()) return {};
  const std::string& before = *std::prev(at);
  if (!before.starts_with('-')) return {};
  const CLI::Option* option = app_.get_option_no_throw(before);
  if (option == nullptr || option->get_items_expected_max() > 0) return {};
  const RenamedOption* meant =
      renamed_option(spec_.name, before, [](const std::string&) { return true; });
  return usage(fmt::format("{} takes no value, and '{}' is one", before, shown(word)),
               meant != nullptr && !meant->tool.empty() ? fmt::format("use {}", meant->now)
                                                        : option->get_description());
}

// "--move 1 0 0": numbers that belong together, as words of their own.
std::optional<Error> CommandLine::value_in_pieces(const std::vector<std::string>& arguments) const {
  const auto is_number = [](const std::string& word) {
    return parse_finite(word.substr(0, word.find_first_not_of("+-.0123456789"))).has_value();
  };
  for (auto at = arguments.begin(); at != arguments.end() && *at != "--"; ++at) {
    const CLI::Option* option = at->starts_with("--") ? app_.get_option_no_throw(*at) : nullptr;
    if (option == nullptr || option->get_type_name().find(',') == std::string::npos) continue;
    const auto end = std::find_if_not(std::next(at), arguments.end(), is_number);
    if (end - at < 3) continue;
    return usage(fmt::format("{} takes one word, not {}", *at, end - at - 1),
                 fmt::format("write {} {}", *at, fmt::join(std::next(at), end, ",")));
  }
  return std::nullopt;
}

Error CommandLine::parse_error(const std::vector<std::string>& arguments,
                               const CLI::ParseError& error) const {
  if (auto unknown = unknown_options(arguments)) return *std::move(unknown);
  auto left = app_.remaining();
  std::erase(left, "--");  // before the input of a file of a batch
  if (!left.empty()) {
    const bool file = form_ == Form::single && spec_.batch;
    for (const CLI::Option* option : app_.get_options()) {
      if (!option->get_required() || !option->empty() || option->get_positional()) continue;
      return Error("usage", fmt::format("{} is missing", option->get_name()),
                   fmt::format("{} is an argument too many; perhaps it is the value of {}",
                               shown_list(left), option->get_name()));
    }
    if (auto value = value_of_flag(arguments, left.front())) return *std::move(value);
    if (auto pieces = value_in_pieces(arguments)) return *std::move(pieces);
    constexpr std::string_view kUnits = " m cm mm in ft s ms f deg rad fps Hz ";
    if (kUnits.find(" " + left.front() + " ") != std::string_view::npos) {
      return usage(fmt::format("unexpected argument {}", shown_list(left)),
                   "write a number and its unit as one word: 1s");
    }
    if (left.front().find('=') != std::string::npos && app_.get_option_no_throw("--set")) {
      return usage(fmt::format("unexpected argument {}", shown_list(left)),
                   "write --set " + left.front());
    }
    return Error(
        "usage",
        fmt::format("unexpected argument{} {}", left.size() == 1 ? "" : "s", shown_list(left)),
        !too_many_hint(spec_.name, arguments).empty() ? too_many_hint(spec_.name, arguments)
        : file ? fmt::format("a file to be written is given with -o; for several inputs, use "
                             "--out-dir DIR; see {} --help",
                             spec_.name)
               : fmt::format("see {} --help", spec_.name));
  }
  // "--plant=left"
  constexpr std::string_view kOfFlag = "Could not convert: ";
  if (const std::string what = error.what(); what.starts_with(kOfFlag)) {
    const std::string given = what.substr(kOfFlag.size());
    const std::size_t equals = given.find(" = ");
    const CLI::Option* flag = app_.get_option_no_throw(given.substr(0, equals));
    if (equals != std::string::npos && flag != nullptr && flag->get_items_expected_max() == 0) {
      return usage(fmt::format("{} takes no value, and '{}' is one", given.substr(0, equals),
                               shown(given.substr(equals + 3))),
                   flag->get_description());
    }
  }
  const bool too_many = form_ == Form::single && spec_.batch &&
                        dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  std::string missing;
  for (const CLI::Option* option : app_.get_options()) {
    if (!option->get_required() || !option->empty()) continue;
    const std::string& type = option->get_type_name();
    missing = fmt::format("give {}{}{}; ", option->get_positional() ? "" : option->get_name() + " ",
                          type.empty() ? option->get_name() : type,
                          type.ends_with(".steps") ? ", which krok-fit makes" : "");
    break;
  }
  // "krok diff walk.anim": what is given beside what is missing
  std::string form;
  std::size_t positionals = 0;
  for (const CLI::Option* option : app_.get_options()) {
    if (!option->get_positional()) continue;
    form += " " + option->get_name();
    ++positionals;
  }
  if (positionals > 1 && !missing.empty()) missing += fmt::format("write {}{}; ", spec_.name, form);
  return Error("usage", error.what(),
               fmt::format("{}see {} --help{}", missing, spec_.name,
                           too_many ? "; for several inputs, use --out-dir DIR" : ""));
}

}  // namespace krok::cli
