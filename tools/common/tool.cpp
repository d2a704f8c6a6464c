#include "tools/common/tool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <new>

#include "core/hash.h"
#include "core/parallel.h"
#include "tools/common/console_progress.h"
#include "tools/common/one_of.h"

namespace krok {

namespace {

constexpr std::size_t kHelpColumn = 34;

// Options that say where results go or how the tool talks, not what the result is.
const char* const kSilentOptions[] = {"help", "version", "output",   "quiet",     "verbose",
                                      "json", "jobs",    "progress", "no-clobber"};

// Nothing can be done about a message that nobody can be told of, so failures are passed over here;
// what matters on standard output is checked once, at the end.
void put(std::FILE* stream, const std::string& text) {
  (void)std::fwrite(text.data(), 1, text.size(), stream);
}

// A program may be started with standard streams closed. The next file opened would take their
// place, and messages would be written into it.
void open_missing_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) < 0) (void)::open("/dev/null", O_RDWR);
  }
}

bool is_silent(const std::string& name) {
  for (const char* silent : kSilentOptions) {
    if (name == silent) return true;
  }
  return false;
}

// "--json" alone means standard output; CLI11 would take the next argument for its value.
std::vector<std::string> arguments_of(int argc, char** argv) {
  std::vector<std::string> arguments;
  bool options_end = false;
  for (int i = 1; i < argc; ++i) {
    std::string argument = argv[i];
    if (argument == "--") options_end = true;
    if (argument == "--json" && !options_end) argument = "--json=-";
    arguments.push_back(std::move(argument));
  }
  return arguments;
}

// Whether two paths lead to one regular file, which need not exist yet. Devices and standard
// streams can be read and written at once.
bool same_file(const std::string& first, const std::string& second) {
  namespace fs = std::filesystem;
  if (first == "-" || second == "-") return false;
  std::error_code error;
  const auto status = fs::status(first, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return false;
  if (fs::equivalent(first, second, error)) return true;
  const fs::path canonical = fs::weakly_canonical(first, error);
  return !error && canonical == fs::weakly_canonical(second, error) && !error;
}

// Where the report of a command line goes that could not be parsed: to a file only if no other
// argument names the same.
std::string report_path(const std::vector<std::string>& arguments) {
  const std::string option = "--json=";
  std::string path;
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    if (argument.rfind(option, 0) == 0) path = argument.substr(option.size());
  }
  for (const std::string& argument : arguments) {
    if (argument.rfind(option, 0) != 0 && same_file(path, argument)) return {};
  }
  return path;
}

std::string help_footer(const ToolSpec& spec) {
  std::string text = "\nExamples:\n";
  for (const auto& example : spec.examples) {
    text += fmt::format("  {}\n      {}\n", example.command, example.does);
  }
  text += fmt::format("\nExit codes:\n  0  {}\n", spec.exit_done);
  if (!spec.exit_no.empty()) text += fmt::format("  1  {}\n", spec.exit_no);
  text += "  2  trouble: usage, input or output; nothing is left half-written\n";
  return text;
}

// CLI11 neither breaks long lines nor keeps to one empty line between groups.
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
    // Options continue under their text, everything else under itself.
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
  std::string make_usage(const CLI::App*, std::string) const override {
    return fmt::format("Usage: {}\n", usage_);
  }
  std::string make_description(const CLI::App* app) const override {
    return app->get_description() + "\n\n";
  }
  std::string make_footer(const CLI::App* app) const override { return app->get_footer(); }
  // Only the value's name, and the default where it has one; types and "REQUIRED" would be noise.
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

// What the user gave for each option, as it was written.
using GivenValues = std::map<const CLI::Option*, std::vector<std::string>>;

// CLI11 replaces what was written ("xyzw") by what it stands for ("1") before anybody can ask for
// it; a transform that is added last sees the values first.
void remember_values(CLI::App& app, GivenValues& values) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_type_size() == 0 || option->get_positional()) continue;
    option->transform([option, &values](const std::string& value) {
      values[option].push_back(value);
      return value;
    });
  }
}

bool names_output(const CLI::Option& option) {
  return option.get_type_name().rfind("OUT", 0) == 0;
}

bool names_input(const CLI::Option& option) {
  return option.get_type_name().rfind("IN", 0) == 0;
}

void note_options(const CLI::App& app, const GivenValues& given, ToolContext& context) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0 || option->get_positional()) continue;
    const std::string name = option->get_single_name();
    const auto found = given.find(option);
    if (found != given.end() && names_output(*option)) {
      for (const std::string& path : found->second) context.destinations.push_back(path);
    }
    if (is_silent(name)) continue;
    if (found == given.end()) {
      context.report.options[name] = context.result_options[name] = true;
      continue;
    }
    const auto& values = found->second;
    context.report.options[name] = values.size() == 1 ? Json(values.front()) : Json(values);
    if (names_output(*option)) continue;
    context.result_options[name] =
        names_input(*option) ? Json(base_name(values.front())) : context.report.options[name];
  }
}

// Two results in one file would leave only the last.
Status check_destinations(const ToolContext& context) {
  const auto& paths = context.destinations;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (same_file(paths[i], paths[j])) {
        return Error("usage", fmt::format("{} would be written twice", paths[i]),
                     "give each result its own file");
      }
    }
  }
  return {};
}

int finish(ToolContext& context, const std::string& json_path, int exit_code) {
  if (json_path.empty()) return exit_code;
  for (const std::string& input : context.refused_inputs) {
    if (same_file(input, json_path)) return kExitTrouble;
  }
  const std::string text =
      context.report.to_json().dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  if (const Status written = write_file(json_path, text); !written) {
    put(stderr, to_text(written.error()) + "\n");
    return kExitTrouble;
  }
  return exit_code;
}

// A message about no file begins with the tool's name.
std::string message_of(const std::string& tool, const Diagnostic& diagnostic) {
  return (diagnostic.where.file.empty() ? tool + ": " : "") + to_text(diagnostic) + "\n";
}

int fail(ToolContext& context, const std::string& json_path, const Error& error) {
  put(stderr, message_of(context.report.tool, error));
  context.report.issues.push_back(error);
  return finish(context, json_path, kExitTrouble);
}

bool standard_output_written() {
  return std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
}

Error standard_output_error() {
  return Error("file-unwritable", "standard output cannot be written", "check where it goes");
}

int finish_output(const std::string& tool) {
  if (standard_output_written()) return kExitDone;
  put(stderr, tool + ": " + to_text(standard_output_error()) + "\n");
  return kExitTrouble;
}

int usage_error(ToolContext& context, const std::string& json_path, const std::string& message) {
  return fail(context, json_path,
              Error("usage", message, fmt::format("see {} --help", context.report.tool)));
}

}  // namespace

std::string version() {
  return KROK_VERSION;
}

void ToolContext::tell(Diagnostic diagnostic) {
  const bool shown = diagnostic.severity == Severity::error ||
                     (!quiet && (verbose || diagnostic.severity != Severity::note));
  if (shown) put(stderr, message_of(report.tool, diagnostic));
  report.issues.push_back(std::move(diagnostic));
}

void ToolContext::tell(const Diagnostics& diagnostics) {
  for (const Diagnostic& diagnostic : diagnostics) tell(diagnostic);
}

void ToolContext::warn(std::string code, std::string message, std::string hint) {
  Diagnostic diagnostic;
  diagnostic.severity = Severity::warning;
  diagnostic.code = std::move(code);
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  tell(std::move(diagnostic));
}

void ToolContext::say(const std::string& line) {
  if (!quiet && !report_on_standard_output) put(stderr, line + "\n");
}

void ToolContext::print(const std::string& text) {
  if (report_on_standard_output) return;
  put(stdout, text);
}

Result<InputFile> ToolContext::open_input(const std::string& path) {
  for (const std::string& destination : destinations) {
    if (same_file(path, destination)) {
      refused_inputs.push_back(path);
      return Error("usage", "is read and would be replaced by a result", "choose another name")
          .in_file(path);
    }
  }
  for (const Report::Input& input : report.inputs) {
    if (path == "-" && input.path == path) {
      return Error("usage", "standard input can be read only once", "name a file for the other");
    }
  }
  auto file = InputFile::open(path);
  if (file) report.inputs.push_back({path, hex(xxh3(file->bytes()))});
  return file;
}

void ToolContext::wrote(const std::string& path) {
  report.outputs.push_back(path);
}

Provenance ToolContext::provenance() const {
  Provenance provenance;
  provenance.tool = report.tool;
  provenance.version = report.version;
  for (const auto& input : report.inputs) {
    provenance.sources.push_back({base_name(input.path), input.xxh3});
  }
  for (const auto& [name, value] : result_options.items()) {
    provenance.options.emplace_back(name,
                                    value.is_string() ? value.get<std::string>() : value.dump());
  }
  for (const Diagnostic& issue : report.issues) {
    if (issue.severity == Severity::warning) {
      provenance.warnings.push_back(fmt::format("{} [{}]", issue.message, issue.code));
    }
  }
  return provenance;
}

int run_tool(const ToolSpec& spec, int argc, char** argv) {
  open_missing_standard_streams();
  remove_temporaries_on_signals();

  ToolContext context;
  context.report.tool = spec.name;
  context.report.version = version();
  std::string json_path;
  ProgressStyle style = ProgressStyle::automatic;

  CLI::App app(spec.summary, spec.name);
  app.footer(help_footer(spec));
  app.formatter(std::make_shared<HelpFormatter>(
      fmt::format("{} [options] {}{}", spec.name, spec.inputs,
                  spec.has_output ? (spec.needs_output ? " -o OUTPUT" : " [-o OUTPUT]") : "")));
  spec.declare(app);
  GivenValues given_values;
  remember_values(app, given_values);
  app.set_help_flag("-h,--help", "This text")->group("Common options");
  app.set_version_flag("--version", fmt::format("{} {}", spec.name, version()), "The version")
      ->group("Common options");
  if (spec.has_output) {
    auto* option = app.add_option("-o,--output", context.output, "Where the result goes")
                       ->type_name("OUTPUT")
                       ->group("Common options");
    if (spec.needs_output) option->required();
    app.add_flag("--no-clobber", context.no_clobber, "Refuse to replace a file that exists")
        ->group("Common options");
  }
  app.add_flag("-q,--quiet", context.quiet, "Errors only")->group("Common options");
  app.add_flag("-v,--verbose", context.verbose, "Notes too")->group("Common options");
  app.add_option("--json", json_path,
                 "A report in JSON on standard output, or with --json=FILE in a file")
      ->type_name("[=FILE]")
      ->group("Common options");
  app.add_option("--progress", style, "Progress: auto, bar, plain, json or none")
      ->type_name("STYLE")
      ->transform(one_of<ProgressStyle>({{"auto", ProgressStyle::automatic},
                                         {"bar", ProgressStyle::bar},
                                         {"plain", ProgressStyle::plain},
                                         {"json", ProgressStyle::json},
                                         {"none", ProgressStyle::none}}))
      ->default_str("auto")
      ->group("Common options");
  app.add_option("-j,--jobs", context.jobs, "Threads; 0 is one a core")
      ->type_name("N")
      ->check(CLI::Range(0, 1024).description(""))
      ->default_str("0")
      ->group("Common options");

  const std::vector<std::string> arguments = arguments_of(argc, argv);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    put(stdout, tidy_help(app.help()));
    return finish_output(spec.name);
  } catch (const CLI::CallForVersion&) {
    put(stdout, fmt::format("{} {}\n", spec.name, version()));
    return finish_output(spec.name);
  } catch (const CLI::ParseError& error) {
    return usage_error(context, report_path(arguments), error.what());
  }

  context.report_on_standard_output = json_path == "-";
  if (context.report_on_standard_output && context.output == "-") {
    return usage_error(context, "", "the report and the output cannot both go to standard output");
  }
  note_options(app, given_values, context);
  for (const std::string& path : {context.output, json_path}) {
    if (!path.empty()) context.destinations.push_back(path);
  }
  if (Status apart = check_destinations(context); !apart) return fail(context, "", apart.error());
  if (context.quiet && style == ProgressStyle::automatic) style = ProgressStyle::none;
  const auto progress = console_progress(style);
  context.progress = progress.get();

  try {
    const Result<int> done = spec.run(context);
    progress->end();
    if (!done) return fail(context, json_path, done.error());
    if (!standard_output_written()) return fail(context, json_path, standard_output_error());
    return finish(context, json_path, *done);
  } catch (const std::bad_alloc&) {
    progress->end();
    return fail(context, json_path, Error("out-of-memory", "there is not enough memory"));
  } catch (const std::exception& error) {
    progress->end();
    return fail(context, json_path,
                Error("internal", fmt::format("a bug in {}: {}", spec.name, error.what()),
                      "please report it with the input that caused it"));
  }
}

}  // namespace krok
