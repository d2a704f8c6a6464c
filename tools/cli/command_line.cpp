#include "tools/cli/command_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>

#include "core/glob.h"
#include "core/nearest_name.h"
#include "core/text.h"
#include "tools/cli/folder_inputs.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/renamed_options.h"
#include "tools/cli/tool.h"

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

// Sets up the layout of --help: usage, option groups, examples, exit codes.
void shape_help(CLI::App& app, const ToolSpec& spec) {
  app.footer(footer(spec));
  app.formatter(std::make_shared<HelpFormatter>(usage_lines(spec)));
}

// The text of --help.
std::string help_text(const CLI::App& app) {
  return tidy_help(app.help());
}

constexpr const char* kCommon = "Common options";
constexpr const char* kMany = "Batch mode";

bool type_begins(const CLI::Option& option, const char* word) {
  return option.get_type_name().rfind(word, 0) == 0;
}

// "'a' 'b'", of at most three.
std::string shown_list(const std::vector<std::string>& words) {
  std::string list;
  for (std::size_t i = 0; i < words.size() && i < 3; ++i) {
    list += fmt::format("{}'{}'", i == 0 ? "" : " ", shown(words[i]));
  }
  return list + (words.size() > 3 ? " ..." : "");
}

bool is_flag(const CLI::Option& option) {
  return option.get_items_expected_max() == 0;
}

}  // namespace

std::vector<std::string> arguments_of(const std::vector<GivenOption>& options) {
  std::vector<std::string> arguments;
  for (const GivenOption& option : options) {
    const std::string dashed = (option.name.size() == 1 ? "-" : "--") + option.name;
    for (const std::string& value : option.values) {
      if (option.is_flag) {
        arguments.push_back(fmt::format("{}={}", dashed, value));
      } else {
        arguments.push_back(dashed);
        arguments.push_back(value);
      }
    }
  }
  return arguments;
}

CommandLine::CommandLine(const ToolSpec& spec, Form form)
    : form_(form),
      declare_(spec.declare),
      app_(spec.details.empty() ? spec.summary : spec.summary + "\n\n" + spec.details, spec.name),
      tool_(spec.name),
      folder_endings_(spec.folder_endings),
      keeps_going_(spec.keeps_going),
      needs_output_(spec.has_output && spec.needs_output),
      default_output_(spec.default_output),
      takes_many_(spec.batch.has_value()) {
  app_.set_help_flag();
  declare_(options_);
  options_.group("Options");
  if (form == Form::many) take_many_inputs();
  for (CLI::Option* option : app_.get_options()) {
    if (!option->get_positional()) own_options_.push_back(option);
  }
  // Required options may be given either by a manifest line or on the command line.
  if (form == Form::many || form == Form::own) {
    for (CLI::Option* option : app_.get_options()) option->required(false);
  }
  if (form == Form::own) {
    std::vector<CLI::Option*> positionals;
    for (CLI::Option* option : app_.get_options()) {
      if (option->get_positional()) positionals.push_back(option);
    }
    for (CLI::Option* option : positionals) options_.remove(option);
  }
  if (form == Form::single || form == Form::many) {
    shape_help(app_, spec);
    if (spec.batch) {
      declare_for_many();
    } else if (spec.keeps_going) {
      declare_keep_going("Leave out inputs that cannot be used");
    }
    declare_common(spec);
  } else if (form == Form::one_file) {
    app_.add_option("-o,--output", output);
    app_.add_flag("--no-clobber", no_clobber);
  }
}

// Turns the last positional into a list.
void CommandLine::take_many_inputs() {
  CLI::Option* last = nullptr;
  for (CLI::Option* option : app_.get_options()) {
    if (option->get_positional()) last = option;
  }
  if (last == nullptr) return;
  const std::string type = last->get_type_name();
  options_.remove(last);
  inputs_option_ = app_.add_option("inputs", inputs, "")->type_name(type);
}

void CommandLine::declare_common(const ToolSpec& spec) {
  app_.set_help_flag("-h,--help", "Print this help; -h a short one")->group(kCommon);
  app_.set_version_flag("--version", fmt::format("{} {}", spec.name, version()),
                        "Print the version")
      ->group(kCommon);
  if (spec.has_output) {
    app_.add_option("-o,--output", output, "Output file")->type_name("OUTPUT")->group(kCommon);
    app_.add_flag("--no-clobber", no_clobber, "Do not overwrite existing files")->group(kCommon);
  }
  app_.add_flag("-q,--quiet", quiet, "Print only errors")->group(kCommon);
  app_.add_flag("-v,--verbose", verbose, "Also print notes")->group(kCommon);
  const std::string& more_names = spec.report_name;
  app_.add_option(more_names.empty() ? "--json" : "--json," + more_names, json_path,
                  "Write a JSON report to standard output, or to FILE with --json=FILE")
      ->type_name("[=FILE]")
      ->group(kCommon);
  options_
      .add("--progress STYLE", style,
           choice<ProgressStyle>({{"auto", ProgressStyle::automatic},
                                  {"bar", ProgressStyle::bar},
                                  {"plain", ProgressStyle::plain},
                                  {"json", ProgressStyle::json},
                                  {"none", ProgressStyle::none}}),
           "Progress display: auto, bar, plain, json or none", "auto")
      .group(kCommon);
  options_.add("-j,--jobs", jobs, whole(0, 1024), "Number of threads; 0: one per core", "0")
      .group(kCommon);
  options_
      .add("--limit-time SECONDS", limit_seconds, number(kPositive),
           "Time for reading a file by another library in a process of its own (FBX, COLLADA and "
           "others, Draco) [15, and 5 per MiB]")
      .group(kCommon);
  options_
      .add("--limit-memory MIB", limit_mebibytes, whole(1, 1 << 24),
           "Memory of that process [256, and 64 times the file's size]")
      .group(kCommon);
}

void CommandLine::declare_keep_going(const char* help) {
  app_.add_flag("--keep-going", keep_going, help)->group(kMany);
}

void CommandLine::declare_for_many() {
  app_.add_option("--out-dir", out_dir,
                  "Process many inputs (files, folders, patterns such as 'takes/**/*.bvh'); write "
                  "the outputs to DIR, in the same sub-folders")
      ->type_name("DIR")
      ->group(kMany);
  app_.add_option("--base", base,
                  "Keep sub-folders relative to FOLDER, not to a pattern's fixed part or the "
                  "common folder of the named files")
      ->type_name("FOLDER")
      ->group(kMany);
  app_.add_option("--manifest", manifest,
                  "List of files, one per line: input, output and options, tab-separated; - is "
                  "standard input")
      ->type_name("LIST.tsv")
      ->group(kMany);
  app_.add_option("--shard", shard, "Process only part I of N of the list")
      ->type_name("I/N")
      ->group(kMany);
  declare_keep_going(keeps_going_
                         ? "Continue after a file fails, also where all files make one output; by "
                           "default, the first failure ends the run"
                         : "Continue after a file fails; by default, the first failure ends the "
                           "run");
  app_.add_flag("--force", force, "Rebuild outputs that are up to date (same input and options)")
      ->group(kMany);
}

void CommandLine::note_given() {
  for (const CLI::Option* option : own_options_) {
    if (option->count() == 0) continue;
    GivenOption given;
    given.name = option->get_single_name();
    given.is_flag = is_flag(*option);
    given.values = option->results();
    if (given.is_flag) {  // "off", "no" and "0" are words for false
      for (std::string& value : given.values) {
        bool on = false;
        (void)CLI::detail::lexical_cast(value, on);
        value = on ? "true" : "false";
      }
    }
    given.names_input = type_begins(*option, "IN");
    given.names_output = type_begins(*option, "OUT");
    given_.push_back(std::move(given));
  }
  if (form_ != Form::many) return;
  for (const CLI::Option* option : app_.get_options()) {
    if (!option->get_positional() || option == inputs_option_) continue;
    for (const std::string& value : option->results()) fixed_positionals.push_back(value);
  }
}

Status CommandLine::check_use_of_batch_options() const {
  const char* const first = !base.empty()                 ? "--base"
                            : !shard.empty()              ? "--shard"
                            : keep_going && !keeps_going_ ? "--keep-going"
                            : force                       ? "--force"
                                                          : nullptr;
  if (form_ != Form::single || first == nullptr) return {};
  return Error("usage", fmt::format("{} is for batch mode only", first),
               "add --out-dir or --manifest");
}

Status CommandLine::open_folders() {
  left_out.clear();
  if (form_ != Form::single || folder_endings_.empty()) return {};
  for (CLI::Option* option : app_.get_options()) {
    if (!option->get_positional() || option->get_items_expected_max() < 2) continue;
    std::vector<std::string> files;
    for (const std::string& value : option->results()) {
      std::error_code unknown;
      if (value == "-" || !std::filesystem::is_directory(value, unknown)) {
        files.push_back(value);
        continue;
      }
      auto found = find_files_below(value);
      if (!found) return found.error();
      for (Diagnostic& diagnostic : keep_inputs(value, folder_endings_, *found)) {
        left_out.push_back(std::move(diagnostic));
      }
      if (found->empty()) {
        return Error("folder-empty",
                     fmt::format("the folder has no {} file", any_of_words(folder_endings_)))
            .in_file(value);
      }
      files.insert(files.end(), found->begin(), found->end());
    }
    if (files == option->results()) continue;
    option->clear();
    option->add_result(std::move(files));
    option->run_callback();
  }
  return {};
}

Result<CommandLine::Wish> CommandLine::parse(const std::vector<std::string>& arguments) {
  given_.clear();
  fixed_positionals.clear();
  if (auto bare = option_without_value(arguments)) return *std::move(bare);
  if (auto dashed = option_with_one_dash(arguments)) return *std::move(dashed);
  try {
    app_.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    return Wish::help;
  } catch (const CLI::CallForVersion&) {
    return Wish::version;
  } catch (const CLI::ParseError& error) {
    if (auto unknown = unknown_option(arguments)) return *std::move(unknown);
    auto left = app_.remaining();
    std::erase(left, "--");  // before the input of a file of a batch
    if (!left.empty()) {
      const bool file = form_ == Form::single && takes_many_;
      for (const CLI::Option* option : app_.get_options()) {
        if (!option->get_required() || !option->empty() || option->get_positional()) continue;
        return Error("usage", fmt::format("{} is missing", option->get_name()),
                     fmt::format("{} is an argument too many; perhaps it is the value of {}",
                                 shown_list(left), option->get_name()));
      }
      constexpr std::string_view kUnits = " m cm mm in ft s ms f deg rad fps Hz ";
      if (kUnits.find(" " + left.front() + " ") != std::string_view::npos) {
        return usage(fmt::format("unexpected argument {}", shown_list(left)),
                     "write a number and its unit as one word: 1s");
      }
      return Error(
          "usage",
          fmt::format("unexpected argument{} {}", left.size() == 1 ? "" : "s", shown_list(left)),
          !too_many_hint(tool_).empty() ? too_many_hint(tool_)
          : file ? fmt::format("a file to be written is given with -o; for several inputs, use "
                               "--out-dir DIR; see {} --help",
                               tool_)
                 : fmt::format("see {} --help", tool_));
    }
    const bool too_many = form_ == Form::single && takes_many_ &&
                          dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    std::string missing;
    for (const CLI::Option* option : app_.get_options()) {
      if (!option->get_required() || !option->empty()) continue;
      const std::string& type = option->get_type_name();
      missing = fmt::format("give {}{}; ", option->get_positional() ? "" : option->get_name() + " ",
                            type.empty() ? option->get_name() : type);
      break;
    }
    return Error("usage", error.what(),
                 fmt::format("{}see {} --help{}", missing, tool_,
                             too_many ? "; for several inputs, use --out-dir DIR" : ""));
  }
  if (Status status = check_use_of_batch_options(); !status) return status.error();
  note_given();
  if (Status status = options_.take_values(); !status) {
    Error error = std::move(status).error();
    if (error.hint.empty()) error.hint = fmt::format("see {} --help", tool_);
    return error;
  }
  if (form_ == Form::single && default_output_ && output.empty()) {
    output = default_output_();
    std::error_code unknown;
    if (!output.empty() && std::filesystem::exists(output, unknown)) {
      return usage(fmt::format("no output given, and {} exists already", shown(output)),
                   "-o OUTPUT names another, or replaces it");
    }
  }
  if (form_ == Form::single && needs_output_ && output.empty()) {
    for (const CLI::Option* option : app_.get_options()) {
      if (!takes_many_ || !option->get_positional() || option->empty()) continue;
      return no_output_for(option->results().front());
    }
    return no_output();
  }
  if (Status status = open_folders(); !status) return status.error();
  // Those of a list stand in part on its lines.
  if (form_ == Form::single || form_ == Form::one_file) {
    if (Status status = options_.check_conditions(); !status) return status.error();
  }
  return Wish::run;
}

// The first option whose value would be the option after it: "--size -o x.png".
std::optional<Error> CommandLine::option_without_value(
    const std::vector<std::string>& arguments) const {
  for (std::size_t i = 0; i + 1 < arguments.size() && arguments[i] != "--"; ++i) {
    const std::string& next = arguments[i + 1];
    if (!arguments[i].starts_with('-') || !next.starts_with('-') || next == "-") continue;
    const CLI::Option* option = app_.get_option_no_throw(arguments[i]);
    if (option == nullptr || option->get_items_expected_min() < 1) continue;
    if (app_.get_option_no_throw(next.substr(0, next.find('='))) == nullptr) continue;
    return usage(fmt::format("{} has no value", arguments[i]),
                 fmt::format("write {} {}; '{}' is the next option", arguments[i],
                             option->get_type_name(), next));
  }
  return std::nullopt;
}

// "-json" would be -j with the value "son".
std::optional<Error> CommandLine::option_with_one_dash(
    const std::vector<std::string>& arguments) const {
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    if (argument.size() < 3 || argument[0] != '-' || argument[1] == '-') continue;
    const std::string name = "-" + argument.substr(0, argument.find('='));
    if (app_.get_option_no_throw(name) == nullptr) continue;
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
    const bool letter = argument.size() == 2 && argument[0] == '-' &&
                        std::isalpha(static_cast<unsigned char>(argument[1])) != 0;
    if (!is_long && !letter) continue;
    const std::string name = argument.substr(0, argument.find('='));
    if (app_.get_option_no_throw(name) != nullptr) continue;
    const auto is_now = [&](const RenamedOption& option) {
      if (option.before != name || (!option.tool.empty() && option.tool != tool_)) return false;
      const std::string now(option.now.substr(0, option.now.find(' ')));
      return !option.tool.empty() || !now.starts_with('-') ||
             app_.get_option_no_throw(now) != nullptr;
    };
    // A tool's own rows come after those of any.
    const auto none = std::rend(kRenamedOptions);
    if (const auto row = std::find_if(std::rbegin(kRenamedOptions), none, is_now); row != none) {
      return usage(fmt::format("unknown option '{}'", name), fmt::format("use {}", row->now));
    }
    const std::string near = is_long ? nearest_name(name, names) : std::string();
    return Error("usage", fmt::format("unknown option '{}'", shown(name)),
                 near.empty() ? fmt::format("see {} --help", tool_)
                              : fmt::format("did you mean '{}'?", near));
  }
  return std::nullopt;
}

std::vector<std::string> CommandLine::expanded(const std::vector<std::string>& arguments) const {
  std::map<std::string, std::vector<std::string>> patterns;
  for (const CLI::Option* option : app_.get_options()) {
    if (!option->get_positional() || !type_begins(*option, "IN")) continue;
    for (const std::string& value : option->results()) {
      std::error_code unknown;
      if (!has_wildcards(value) || std::filesystem::exists(value, unknown)) continue;
      auto found = find_files(value);
      if (found && !found->empty()) patterns[value] = *std::move(found);
    }
  }
  std::vector<std::string> result;
  for (const std::string& argument : arguments) {
    const auto found = patterns.find(argument);
    if (found == patterns.end()) {
      result.push_back(argument);
    } else {
      result.insert(result.end(), found->second.begin(), found->second.end());
    }
  }
  return result;
}

std::string CommandLine::help() const {
  return help_text(app_);
}

std::string CommandLine::short_help(const ToolSpec& spec) const {
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
  std::string text = fmt::format("{}\n\n{}\nOptions; {} --help explains them:\n", spec.summary,
                                 usage_lines(spec), spec.name);
  for (const auto& [group, names] : groups) text += fmt::format("  {}: {}\n", group, names);
  return tidy_help(text + examples_of(spec));
}

GivenLimits CommandLine::limits() const {
  GivenLimits limits;
  limits.seconds = limit_seconds;
  if (limit_mebibytes) limits.memory_bytes = static_cast<std::uint64_t>(*limit_mebibytes) << 20;
  return limits;
}

ToolContext CommandLine::context() const {
  ToolContext context;
  context.report.tool = tool_;
  context.report.version = version();
  context.jobs = jobs;
  context.keep_going = keep_going;
  context.limits = limits();
  context.no_clobber = no_clobber;
  context.quiet = quiet;
  context.verbose = verbose;
  context.output = output;
  context.report_path = json_path;
  context.report_on_standard_output = json_path == "-";
  for (const GivenOption& option : given_) {
    const Json value = option.is_flag              ? Json(option.values.back() != "false")
                       : option.values.size() == 1 ? Json(option.values.front())
                                                   : Json(option.values);
    context.report.options[option.name] = value;
    if (option.names_output) {
      for (const std::string& path : option.values) context.destinations.push_back(path);
      continue;
    }
    if (!option.names_input) {
      context.result_options[option.name] = value;
      continue;
    }
    Json names = Json::array();
    for (const std::string& path : option.values) names.push_back(base_name(path));
    context.result_options[option.name] = names.size() == 1 ? names.front() : names;
  }
  for (const std::string& path : {output, json_path}) {
    if (!path.empty()) context.destinations.push_back(path);
  }
  return context;
}

}  // namespace krok::cli
