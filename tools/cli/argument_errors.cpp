#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>
#include <string>
#include <string_view>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "tools/cli/command_line.h"
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

// The words of a text that say something, in small letters and in the singular.
std::set<std::string> words_in(std::string_view text) {
  std::set<std::string> words;
  std::string word;
  const auto end_word = [&] {
    if (word == "feet") word = "foot";
    if (word.size() > 3 && word.ends_with('s')) word.pop_back();
    constexpr std::string_view kEmpty = " the and for with not from out its are set use add all ";
    if (word.size() > 2 && kEmpty.find(" " + word + " ") == std::string_view::npos) {
      words.insert(word);
    }
    word.clear();
  };
  for (const char c : text) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += ascii_lower(c);
    } else {
      end_word();
    }
  }
  end_word();
  return words;
}

}  // namespace

// "--match-heights" where there are --height and --match-height: up to three with a word of it.
std::string CommandLine::options_about(const std::string& name) const {
  const std::set<std::string> wanted = words_in(name);
  std::vector<std::pair<std::ptrdiff_t, std::string>> found;
  for (const OptionFacts& option : options_.facts()) {
    if (option.positional) continue;
    const auto words = words_in(option.names.back());
    const auto score = std::ranges::count_if(
        wanted, [&](const std::string& word) { return words.contains(word); });
    if (score == 0) continue;
    found.emplace_back(-score, option.value_name.empty()
                                   ? option.names.back()
                                   : option.names.back() + " " + option.value_name);
  }
  std::ranges::stable_sort(found, {}, &std::pair<std::ptrdiff_t, std::string>::first);
  std::string list;
  for (std::size_t i = 0; i < found.size() && i < 3; ++i)
    list += (i == 0 ? "" : ", ") + found[i].second;
  return list;
}

// The first option whose value would be the option after it: "--size -o x.png".
std::optional<Error> CommandLine::option_without_value(
    const std::vector<std::string>& arguments) const {
  for (std::size_t i = 0; i + 1 < arguments.size() && arguments[i] != "--"; ++i) {
    const std::string& next = arguments[i + 1];
    if (!arguments[i].starts_with('-') || !next.starts_with('-') || next == "-") continue;
    const CLI::Option* option = app_.get_option_no_throw(arguments[i]);
    if (option == nullptr) continue;
    if (option->get_items_expected_min() < 1) continue;
    // "--fix -o fixed", of a tool without -o.
    const bool is_option = next == "-o" || (next.starts_with("--") && next.size() > 2) ||
                           app_.get_option_no_throw(next.substr(0, next.find('='))) != nullptr;
    if (!is_option) continue;
    return usage(fmt::format("{} has no value", arguments[i]),
                 fmt::format("write {} {}; '{}' is the next option", arguments[i],
                             option->get_type_name(), next));
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

// The first word before "--" that looks like an option and is none.
std::optional<Error> CommandLine::unknown_option(const std::vector<std::string>& arguments) const {
  std::vector<std::string> names;
  for (const OptionFacts& option : options_.facts()) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    const bool is_long = argument.starts_with("--");
    const bool letter = argument.size() >= 2 && argument[0] == '-' &&
                        std::isalpha(static_cast<unsigned char>(argument[1])) != 0;
    if (!is_long && !letter) continue;
    const std::string name = argument.substr(0, argument.find('='));
    if (app_.get_option_no_throw(is_long ? name : name.substr(0, 2)) != nullptr) continue;
    std::string dashed = name;  // as options are written here: --frame-rate for --frame_rate
    std::ranges::replace(dashed, '_', '-');
    const auto has = [&](const std::string& option) {
      return app_.get_option_no_throw(option) != nullptr;
    };
    if (const RenamedOption* row = renamed_option(spec_.name, dashed, has)) {
      return usage(fmt::format("unknown option '{}'", name), fmt::format("use {}", row->now));
    }
    std::vector<std::string> hints;
    if (is_long && spec_.tools_with) {
      auto tools = spec_.tools_with(dashed);
      // Of a word with many uses it says nothing.
      if (tools.size() > 2) tools.clear();
      for (const auto& [tool, does] : tools) {
        if (tool == "krok-retarget" && has("--retarget")) {
          hints.push_back(
              fmt::format("krok-retarget IN --onto CHARACTER -o OUT.anim has it; its "
                          "motion needs no --retarget here"));
          continue;
        }
        // "keep: hands touch the ground; free: ..." says nothing without its second word.
        const std::size_t end = does.find_first_of(".;:");
        const std::string first =
            does.substr(0, end < 20 ? does.find_first_of(".;", end + 1) : end);
        hints.push_back(fmt::format("{} has it: {}", tool, first));
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
      const std::string about = options_about(dashed);
      if (!about.empty()) hints.push_back(fmt::format("{} has {}", spec_.name, about));
    }
    if (near.empty()) hints.push_back(fmt::format("see {} --help", spec_.name));
    return Error("usage", fmt::format("unknown option '{}'", shown(name)),
                 fmt::format("{}", fmt::join(hints, "; ")));
  }
  return std::nullopt;
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
               meant != nullptr ? fmt::format("use {}", meant->now) : option->get_description());
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
  if (auto unknown = unknown_option(arguments)) return *std::move(unknown);
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
  return Error("usage", error.what(),
               fmt::format("{}see {} --help{}", missing, spec_.name,
                           too_many ? "; for several inputs, use --out-dir DIR" : ""));
}

}  // namespace krok::cli
