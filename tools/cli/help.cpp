#include "tools/cli/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string_view>

namespace krok::cli {

namespace {

constexpr std::size_t kHelpColumn = 34;

std::string usage(const ToolSpec& spec) {
  std::string text =
      fmt::format("Usage: {} [options] {}{}\n", spec.name, spec.inputs,
                  spec.has_output ? (spec.needs_output ? " -o OUTPUT" : " [-o OUTPUT]") : "");
  if (spec.batch) {
    const bool ends_so = std::string_view(spec.inputs).ends_with("...");
    text += fmt::format("       {} [options] {}{} --out-dir DIR\n", spec.name, spec.inputs,
                        ends_so ? "" : "...");
    text += fmt::format("       {} [options] --manifest LIST.tsv\n", spec.name);
  }
  return text;
}

std::string footer(const ToolSpec& spec) {
  std::string text = "\nExamples:\n";
  for (const auto& example : spec.examples) {
    text += fmt::format("  {}\n      {}\n", example.command, example.does);
  }
  text += fmt::format("\nExit codes:\n  0  {}\n", spec.exit_done);
  if (!spec.exit_no.empty()) text += fmt::format("  1  {}\n", spec.exit_no);
  text += "  2  error: usage, input or output; no partial output is left\n";
  if (!spec.exit_partly.empty()) text += fmt::format("  3  {}\n", spec.exit_partly);
  if (spec.batch) text += "  3  with --keep-going: some files failed, all others were processed\n";
  return text;
}

// CLI11 neither wraps long lines nor limits empty lines between groups to one.
std::string tidy_help(const std::string& help) {
  constexpr std::size_t kWidth = 100;
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
    const std::size_t indent = option ? kHelpColumn : std::min(line.find_first_not_of(' '), kWidth);
    while (line.size() > kWidth) {
      std::size_t space = line.rfind(' ', kWidth);
      if (space == std::string::npos || space <= indent) space = line.find(' ', kWidth);
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

void shape_help(CLI::App& app, const ToolSpec& spec) {
  app.footer(footer(spec));
  app.formatter(std::make_shared<HelpFormatter>(usage(spec)));
}

std::string help_text(const CLI::App& app) {
  return tidy_help(app.help());
}

}  // namespace krok::cli
