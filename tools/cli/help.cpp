#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>

#include "tools/cli/command_line.h"

// The texts of --help and -h.

namespace krok::cli {

namespace {

constexpr std::size_t kHelpColumn = 34;

std::string usage_lines(const ToolSpec& spec) {
  std::string text = fmt::format(
      "Usage: {} [options] {}{}\n", spec.name, spec.inputs,
      spec.has_output ? (spec.needs_output && !spec.default_output ? " -o OUTPUT" : " [-o OUTPUT]")
                      : "");
  if (spec.batch) {
    const bool ends_so = std::string_view(spec.inputs).ends_with("...");
    text += fmt::format("       {} [options] {}{} --out-dir DIR\n", spec.name, spec.inputs,
                        ends_so ? "" : "...");
    text += fmt::format("       {} [options] --manifest LIST.tsv\n", spec.name);
  }
  return text;
}

std::string examples_of(const ToolSpec& spec) {
  std::string text = "\nExamples:\n";
  for (const auto& example : spec.examples) {
    text += fmt::format("  {}\n      {}\n", example.command, example.does);
  }
  return text;
}

std::string footer(const ToolSpec& spec) {
  std::string text = examples_of(spec);
  text += fmt::format("\nExit codes:\n  0  {}\n", spec.exit_done);
  if (!spec.exit_no.empty()) text += fmt::format("  1  {}\n", spec.exit_no);
  text += "  2  error: usage, input or output; no partial output is left\n";
  if (!spec.exit_partly.empty()) text += fmt::format("  3  {}\n", spec.exit_partly);
  if (spec.batch || spec.keeps_going) {
    text += "  3  with --keep-going: some files failed, all others were processed\n";
  }
  return text;
}

// The columns of the terminal that standard output is, within limits.
std::size_t help_width() {
  constexpr std::size_t kMinWidth = 30, kMaxWidth = 100;
  winsize size{};
  const bool known = isatty(STDOUT_FILENO) != 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0;
  if (!known || size.ws_col == 0) return kMaxWidth;
  return std::clamp<std::size_t>(size.ws_col, kMinWidth, kMaxWidth);
}

// CLI11 neither wraps long lines nor limits empty lines between groups to one.
std::string tidy_help(const std::string& help) {
  constexpr std::size_t kNarrow = 72;  // below it, descriptions are under their options
  constexpr std::size_t kNarrowIndent = 6;
  const std::size_t width = help_width();
  std::string tidy;
  bool empty_before = true;
  for (std::size_t at = 0; at < help.size();) {
    const std::size_t end = std::min(help.find('\n', at), help.size());
    std::string line = help.substr(at, end - at);
    at = end + 1;
    if (line.empty() && empty_before) continue;
    empty_before = line.empty();
    // Option descriptions wrap to their column, all other lines to their own indentation.
    const bool option = line.size() > kHelpColumn && line[0] == ' ' &&
                        line.find_first_not_of(' ') == 2 && line[kHelpColumn - 1] == ' ';
    std::size_t indent = option ? kHelpColumn : std::min(line.find_first_not_of(' '), width);
    // A line of nothing but a description follows a name that is longer than its column.
    const bool description = line.size() > kHelpColumn && indent == kHelpColumn;
    if (width < kNarrow && description) {
      const std::string name = line.substr(0, kHelpColumn);
      const std::size_t end_of_name = name.find_last_not_of(' ');
      if (end_of_name != std::string::npos) tidy += name.substr(0, end_of_name + 1) + "\n";
      indent = kNarrowIndent;
      line = std::string(indent, ' ') + line.substr(kHelpColumn);
    }
    while (line.size() > width) {
      std::size_t space = line.rfind(' ', width);
      if (space == std::string::npos || space <= indent) space = line.find(' ', width);
      if (space == std::string::npos) break;
      tidy += line.substr(0, space) + "\n";
      line = std::string(indent, ' ') + line.substr(space + 1);
    }
    tidy += line + "\n";
  }
  return tidy;
}

class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(std::string usage) : usage_(std::move(usage)) {
    column_width(kHelpColumn);
    label("REQUIRED", "(required)");
  }
  std::string make_usage(const CLI::App*, std::string) const override { return usage_; }
  std::string make_description(const CLI::App* app) const override {
    return app->get_description() + "\n\n";
  }
  std::string make_footer(const CLI::App* app) const override { return app->get_footer(); }
  // Removes "{false}" after a negated flag.
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    std::string name = CLI::Formatter::make_option_name(option, is_positional);
    for (std::size_t at; (at = name.find('{')) != std::string::npos;) {
      name.erase(at, name.find('}', at) - at + 1);
    }
    return name;
  }
  // Only the value name and the default; no types and "REQUIRED".
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text;
    if (option->get_type_size() != 0) {
      if (!option->get_type_name().empty()) text += " " + option->get_type_name();
      if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
    }
    return text;
  }

 private:
  std::string usage_;
};

}  // namespace

void CommandLine::shape_help() {
  app_.footer(footer(spec_));
  app_.formatter(std::make_shared<HelpFormatter>(usage_lines(spec_)));
}

std::string CommandLine::help() const {
  return tidy_help(app_.help());
}

std::string CommandLine::short_help() const {
  std::vector<std::pair<std::string, std::string>> groups;  // in the order of --help
  for (const CLI::Option* option : app_.get_options()) {
    const std::string& group = option->get_group();
    if (option->get_positional() || group.empty()) continue;
    auto place = std::ranges::find(groups, group, &std::pair<std::string, std::string>::first);
    if (place == groups.end()) place = groups.insert(groups.end(), {group, ""});
    std::string& names = place->second;
    const auto& longs = option->get_lnames();
    names += names.empty() ? "" : ", ";
    names += longs.empty() ? "-" + option->get_snames().front() : "--" + longs.front();
  }
  std::string text = fmt::format("{}\n\n{}\nOptions; {} --help explains them:\n", spec_.summary,
                                 usage_lines(spec_), spec_.name);
  for (const auto& [group, names] : groups) text += fmt::format("  {}: {}\n", group, names);
  return tidy_help(text + examples_of(spec_));
}

}  // namespace krok::cli
