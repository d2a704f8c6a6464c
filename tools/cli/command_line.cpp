#include "tools/cli/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>

#include "core/glob.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/open_scene.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/paths.h"

namespace krok::cli {

namespace {

constexpr const char* kCommon = "Common options";
constexpr const char* kMany = "Batch mode";

bool type_begins(const CLI::Option& option, const char* word) {
  return option.get_type_name().rfind(word, 0) == 0;
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

CommandLine::CommandLine(ToolSpec spec, Form form)
    : form_(form),
      spec_(std::move(spec)),
      app_(spec_.details.empty() ? spec_.summary : spec_.summary + "\n\n" + spec_.details,
           spec_.name) {
  app_.set_help_flag();
  spec_.declare(options_);
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
    shape_help();
    if (spec_.batch) {
      declare_for_many();
    } else if (spec_.keeps_going) {
      declare_keep_going("Leave out inputs that cannot be used");
    }
    declare_common();
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

void CommandLine::declare_common() {
  app_.set_help_flag("-h,--help", "Print this help; -h a short one")->group(kCommon);
  app_.set_version_flag("--version", fmt::format("{} {}", spec_.name, version()),
                        "Print the version")
      ->group(kCommon);
  if (spec_.has_output) {
    app_.add_option("-o,--output", output, "Output file")->type_name("OUTPUT")->group(kCommon);
    app_.add_flag("--no-clobber", no_clobber, "Do not overwrite existing files")->group(kCommon);
  }
  app_.add_flag("-q,--quiet", quiet, "Print only errors")->group(kCommon);
  app_.add_flag("-v,--verbose", verbose, "Also print notes")->group(kCommon);
  const std::string& more_names = spec_.report_name;
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
           "CPU time for reading a file by another library in a process of its own (FBX, COLLADA "
           "and "
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
  declare_keep_going(spec_.keeps_going
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
  const char* const first = !base.empty()                      ? "--base"
                            : !shard.empty()                   ? "--shard"
                            : keep_going && !spec_.keeps_going ? "--keep-going"
                            : force                            ? "--force"
                                                               : nullptr;
  if (form_ != Form::single || first == nullptr) return {};
  return Error("usage", fmt::format("{} is for batch mode only", first),
               "add --out-dir or --manifest");
}

Status CommandLine::open_folders() {
  left_out.clear();
  of_folder = false;
  if (form_ != Form::single || spec_.folder_endings.empty()) return {};
  const bool each = spec_.each_animation && spec_.each_animation(output);
  for (CLI::Option* option : app_.get_options()) {
    if (!option->get_positional() || option->get_items_expected_max() < 2) continue;
    std::vector<std::string> files;
    const auto add = [&](const std::string& path) {
      if (!each) return files.push_back(path);
      std::ranges::copy(io::addresses_in(path, limits(), left_out), std::back_inserter(files));
    };
    for (const std::string& value : option->results()) {
      std::error_code unknown;
      if (value == "-" || !std::filesystem::is_directory(value, unknown)) {
        add(value);
        continue;
      }
      of_folder = true;
      auto found = find_files_below(value);
      if (!found) return found.error();
      for (Diagnostic& diagnostic : keep_inputs(value, spec_.folder_endings, *found)) {
        left_out.push_back(std::move(diagnostic));
      }
      if (found->empty()) {
        return Error("folder-empty",
                     fmt::format("the folder has no {} file", either_of(spec_.folder_endings)))
            .in_file(value);
      }
      std::ranges::for_each(*found, add);
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
  if (auto apart = json_file_apart(arguments)) return *std::move(apart);
  try {
    app_.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    return Wish::help;
  } catch (const CLI::CallForVersion&) {
    return Wish::version;
  } catch (const CLI::ParseError& error) {
    return parse_error(arguments, error);
  }
  // "--quantize 16 walk.anim", "hero.glb walk.anim --compress draco": taken for an input.
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const bool word =
        i > 2 && !arguments[i].empty() && std::ranges::all_of(arguments[i], [](char c) {
          return std::isalnum(static_cast<unsigned char>(c)) != 0;
        });
    if (!(word || parse_finite(arguments[i])) || std::filesystem::exists(arguments[i])) continue;
    if (auto value = value_of_flag(arguments, arguments[i])) return *std::move(value);
  }
  if (Status status = check_use_of_batch_options(); !status) return status.error();
  note_given();
  if (Status status = options_.take_values(); !status) {
    Error error = std::move(status).error();
    if (error.hint.empty()) error.hint = fmt::format("see {} --help", spec_.name);
    return error;
  }
  if (form_ == Form::single && spec_.default_output && output.empty()) {
    output = spec_.default_output();
    output_is_default = !output.empty();
    std::error_code unknown;
    if (!output.empty() && std::filesystem::exists(output, unknown)) {
      return usage(fmt::format("no output given, and {} exists already", shown(output)),
                   "-o OUTPUT names another, or replaces it");
    }
  }
  if (form_ == Form::single && spec_.name != "krok-import" &&
      output.find("{clip}") != std::string::npos) {
    return usage(
        fmt::format("-o {}: there is one output, and no clip to name it by", shown(output)),
        spec_.batch ? "--out-dir DIR writes a file for each motion, of its name"
                    : "write the name of the file");
  }
  if (form_ == Form::single && spec_.has_output && spec_.needs_output && output.empty()) {
    std::vector<std::string> given;
    for (const CLI::Option* option : app_.get_options()) {
      if (option->get_positional()) std::ranges::copy(option->results(), std::back_inserter(given));
    }
    // "krok export walk.anim walk.glb"
    std::error_code unknown;
    if (given.size() > 1 && !extension(given.back()).empty() &&
        !std::filesystem::exists(given.back(), unknown)) {
      return no_output(fmt::format("write -o {}", shown(given.back())));
    }
    return spec_.batch && !given.empty() ? no_output_for(given.front()) : no_output();
  }
  if (Status status = open_folders(); !status) return status.error();
  if (of_folder) {
    if (Status status = options_.take_values(); !status) return status.error();
  }
  // Those of a list stand in part on its lines.
  if (form_ == Form::single || form_ == Form::one_file) {
    if (Status status = options_.check_conditions(); !status) return status.error();
  }
  return Wish::run;
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

GivenLimits CommandLine::limits() const {
  GivenLimits limits;
  limits.seconds = limit_seconds;
  if (limit_mebibytes) limits.memory_bytes = static_cast<std::uint64_t>(*limit_mebibytes) << 20;
  return limits;
}

ToolContext CommandLine::context() const {
  ToolContext context;
  context.report.tool = spec_.name;
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
