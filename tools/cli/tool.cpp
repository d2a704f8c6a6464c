#include "tools/cli/tool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

#include "core/file.h"
#include "core/text.h"
#include "tools/cli/command_line.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"

namespace krok::cli {

namespace {

// Prints what krok completion reads; not in the help.
constexpr const char* kListOptions = "--list-options";

// A program may be started with standard streams closed. The next opened file would get their
// descriptor, and messages would be written into it.
void open_missing_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) < 0) (void)::open("/dev/null", O_RDWR);
  }
}

// Outputs wait for each other without names, each with a descriptor; many systems allow few unless
// asked.
void allow_many_descriptors() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  constexpr rlim_t kWantedDescriptors = 65536;
  limit.rlim_cur = std::max(limit.rlim_cur, std::min(limit.rlim_max, kWantedDescriptors));
  (void)setrlimit(RLIMIT_NOFILE, &limit);
}

// "--json" alone means standard output; CLI11 would take the next argument as its value.
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

// Report path if the command line cannot be parsed: a file only if no other argument names it.
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

// Of two outputs in one file only the last would remain.
Status check_destinations(const ToolContext& context) {
  const auto& paths = context.destinations;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (same_file(paths[i], paths[j])) {
        return twice_error(paths[i]);
      }
    }
  }
  return {};
}

// The report file, opened before the run, so that the run fails early if it cannot be written.
using ReportFile = std::optional<OutputFile>;

Status begin_report(const ToolContext& context, ReportFile& file) {
  if (context.report_path.empty()) return {};
  auto created = OutputFile::create(context.report_path, {.no_clobber = context.no_clobber});
  if (!created) return created.error();
  file = std::move(*created);
  return {};
}

int finish(ToolContext& context, ReportFile& file, int exit_code) {
  if (!file) return exit_code;
  for (const std::string& input : context.refused_inputs) {
    if (same_file(input, context.report_path)) return kExitTrouble;
  }
  const std::string text = json_text(context.report.to_json(), 2) + "\n";
  (void)file->write(text).ok();  // errors are kept and returned by place_all()
  std::vector<OutputFile> files = std::move(context.files_with_report);
  const bool all_wait = files.size() >= context.report.outputs.size();
  context.files_with_report.clear();
  files.push_back(std::move(*file));
  if (const Status status = OutputFile::place_all(files); !status) {
    Error error = status.error();
    if (!all_wait) error.hint = "the outputs were written";
    write_message(context.console, to_text(error) + "\n");
    return kExitTrouble;
  }
  for (const std::string& line : context.lines_with_report) context.log(line);
  return exit_code;
}

int fail(ToolContext& context, ReportFile& file, const Error& error) {
  if (!context.files_with_report.empty()) context.report.outputs.clear();
  context.files_with_report.clear();
  context.lines_with_report.clear();
  context.diagnose(error);
  return finish(context, file, kExitTrouble);
}

// Errors before the report exists.
int fail(ToolContext& context, const Error& error) {
  context.diagnose(error);
  return kExitTrouble;
}

bool standard_output_written() {
  return std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
}

Error standard_output_error() {
  return Error("file-unwritable", "cannot write to standard output",
               "check where it is redirected to");
}

int run_single(const CommandLine& line) {
  const ToolSpec& spec = line.spec();
  ToolContext context = line.context();
  if (context.report_on_standard_output && context.output == "-") {
    return fail(context,
                Error("usage", "the report and the output cannot both go to standard output",
                      fmt::format("see {} --help", spec.name)));
  }
  if (Status status = check_destinations(context); !status) return fail(context, status.error());
  ReportFile report;
  if (Status status = begin_report(context, report); !status) return fail(context, status.error());
  const bool silent = context.quiet && line.style == ProgressStyle::automatic;
  const auto console = console_progress(silent ? ProgressStyle::none : line.style);
  context.console = console.get();
  context.progress = console.get();
  for (const Diagnostic& diagnostic : line.left_out) context.diagnose(diagnostic);
  context.of_folder = line.of_folder;
  const Status status = spec.check ? spec.check() : Status();
  const Result<int> done = status ? run_guarded(spec, context) : Result<int>(status.error());
  console->end();
  context.end_messages();
  if (!done) {
    Error error = done.error();
    if (error.code == "file-directory" && spec.batch) {
      const bool of_option = std::ranges::any_of(line.given(), [&](const GivenOption& option) {
        return std::ranges::find(option.values, error.where.file) != option.values.end();
      });
      error.hint = of_option ? "give one of its files"
                   : !spec.folder_endings.empty()
                       ? "a folder is given without NAME=, which names a single motion"
                       : "to process a folder, use --out-dir DIR instead of -o";
    }
    if (error.code == "file-directory" && (spec.name == "krok-walk" || spec.name == "krok-synth")) {
      error.hint = "krok-fit " + error.where.file + " -o OUT.steps makes a library of its steps";
    }
    if (error.code == "file-missing") {
      if (error.hint == "check the path") error.hint = missing_file_hint(error.where.file);
      // "krok-view walk.anim page.html"
      const std::string written = " .html .htm .svg .pdf .png .mp4 .gif .webp .glb ";
      if (spec.has_output &&
          written.find(" " + extension(error.where.file) + " ") < written.size()) {
        error.hint = "check the path; a file to be written is given with -o";
      }
      for (const OptionFacts& option : line.options()) {
        const auto has = [&](const GivenOption& given) {
          return !option.positional && option.names.back() == "--" + given.name &&
                 std::ranges::find(given.values, error.where.file) != given.values.end();
        };
        if (std::ranges::none_of(line.given(), has)) continue;
        error.hint = fmt::format("check the path; {} {}: {}", option.names.back(),
                                 option.value_name, option.description);
      }
    }
    return fail(context, report, error);
  }
  if (!standard_output_written()) return fail(context, report, standard_output_error());
  // "krok export walk.anim --format csv > walk.csv"
  struct stat standard_output {};
  if (line.output_is_default && fstat(STDOUT_FILENO, &standard_output) == 0 &&
      S_ISREG(standard_output.st_mode) && standard_output.st_size == 0) {
    context.log("standard output goes to a file, which is left empty: -o - writes there");
  }
  const bool partly = *done == kExitDone && !context.left_out.empty();
  if (partly) {
    constexpr std::size_t kNamed = 5;
    std::vector<std::string> names;
    for (const std::string& path : context.left_out) {
      if (names.size() < kNamed) names.push_back(shown(path));
    }
    if (context.left_out.size() > kNamed) names.emplace_back("...");
    context.log(fmt::format("{} left out: {}", counted(context.left_out.size(), "input"),
                            fmt::join(names, ", ")));
  }
  return finish(context, report, partly ? kExitPartly : *done);
}

// For a command line that cannot be parsed.
int fail_usage(const ToolSpec& spec, const std::vector<std::string>& arguments, bool many,
               const Error& error) {
  ToolContext context;
  context.report.tool = spec.name;
  context.report.version = version();
  context.report_path = report_path(arguments);
  const auto end = std::find(arguments.begin(), arguments.end(), "--");
  context.no_clobber = std::find(arguments.begin(), end, "--no-clobber") != end;
  if (many && !only_a_report_stands_at(context.report_path)) {
    context.report_path.clear();  // a pattern may match it
  }
  ReportFile report;
  const Status status = begin_report(context, report);
  const int code = fail(context, report, error);
  return status ? code : fail(context, status.error());
}

// A line for each option: names, V if it takes a value, that value's name, words that it must be
// one of, description, kind of value; separated by tabs. For krok completion.
int list_options(const ToolSpec& spec) {
  std::string text;
  for (const OptionFacts& option : CommandLine(spec, CommandLine::Form::single).options()) {
    const auto joined = [](const std::vector<std::string>& words) {
      std::string list;
      for (const std::string& word : words) list += (list.empty() ? "" : " ") + word;
      return list;
    };
    std::string description = option.description;
    std::ranges::replace(description, '\n', ' ');
    text +=
        fmt::format("{}\t{}\t{}\t{}\t{}\t{}\n", joined(option.names), option.takes_value ? "V" : "",
                    option.value_name, joined(option.words), description, option.kind);
  }
  return print_and_end(spec.name, text);
}

int run_arguments(const MakeToolSpec& make_spec, const std::vector<std::string>& arguments,
                  const ManyFiles& many_files) {
  const ToolSpec spec = make_spec();
  if (arguments.size() == 1 && arguments[0] == kListOptions) return list_options(spec);
  const bool many = spec.batch && many_files.asked_for && many_files.asked_for(arguments);
  CommandLine line(spec, many ? CommandLine::Form::many : CommandLine::Form::single);
  auto wish = line.parse(arguments);
  // In batch mode the list expands patterns.
  const auto expanded = many || !wish ? arguments : line.expanded(arguments);
  if (expanded != arguments) wish = line.parse(expanded);
  if (!wish) return fail_usage(spec, arguments, many, wish.error());
  if (*wish == CommandLine::Wish::version) {
    return print_and_end(spec.name, fmt::format("{} {}\n", spec.name, version_of_build()));
  }
  // The help is that of single-file mode, whatever else was given.
  if (*wish == CommandLine::Wish::help) {
    const CommandLine single(spec, CommandLine::Form::single);
    const bool is_short = std::ranges::find(arguments, "-h") != arguments.end();
    return print_and_end(spec.name, is_short ? single.short_help() : single.help());
  }
  return many ? many_files.run(make_spec, line) : run_single(line);
}

// Converts the current exception to an Error; call in a catch clause.
Error error_of_exception(const std::string& tool) {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return Error("out-of-memory", "out of memory");
  } catch (const std::exception& error) {
    return Error("internal", fmt::format("a bug in {}: {}", tool, error.what()),
                 "please report it with the input that caused it");
  }
}

constexpr std::size_t kMaxName = 64;
char name_when_ending[kMaxName] = "krok";

// When memory is exhausted, destructors may throw (those of JSON values allocate) and exceptions
// may fail to allocate. Neither can be caught.
[[noreturn]] void exit_out_of_memory() {
  remove_temporaries();
  for (const char* words :
       {static_cast<const char*>(name_when_ending), ": error: out of memory [out-of-memory]\n"}) {
    (void)!::write(STDERR_FILENO, words, std::strlen(words));
  }
  _exit(kExitTrouble);
}

// Terminate handler, for exceptions that cannot be caught.
void end_by_exception() {
  try {
    if (std::current_exception()) throw;
  } catch (const std::bad_alloc&) {
  } catch (...) {
    std::abort();  // a bug
  }
  exit_out_of_memory();
}

void install_out_of_memory_handler(const char* path) {
  const char* slash = std::strrchr(path, '/');
  std::strncpy(name_when_ending, slash == nullptr ? path : slash + 1, kMaxName - 1);
  std::set_terminate(end_by_exception);
}

}  // namespace

std::function<Result<std::string>()> always(std::string ending) {
  return [ending = std::move(ending)] { return ending; };
}

Result<int> run_guarded(const ToolSpec& spec, ToolContext& context) {
  if (spec.writes) {
    Status status = check_output_kind(context.output, "-o", *spec.writes);
    if (!status) return status.error();
  }
  if (!spec.output_endings.empty()) {
    if (const auto named = output(spec.output_endings).read(context.output); !named) {
      return usage("-o: " + named.error().message, named.error().hint);
    }
  }
  try {
    return spec.run(context);
  } catch (const std::exception&) {
    return error_of_exception(spec.name);
  }
}

int print_and_end(const std::string& tool, const std::string& text) {
  (void)std::fwrite(text.data(), 1, text.size(), stdout);
  if (standard_output_written()) return kExitDone;
  write_message(nullptr, message_of(tool, standard_output_error()));
  return kExitTrouble;
}

int run_tool(const MakeToolSpec& make_spec, int argc, char** argv, const ManyFiles& many) {
  // Memory of one file serves the next: to give it back takes up to half of a batch's time.
  mallopt(M_MMAP_THRESHOLD, 4 << 20);
  mallopt(M_TRIM_THRESHOLD, 16 << 20);
  open_missing_standard_streams();
  allow_many_descriptors();
  remove_temporaries_on_signals();
  install_out_of_memory_handler(argc > 0 ? argv[0] : "krok");
  try {
    return run_arguments(make_spec, arguments_of(argc, argv), many);
  } catch (const std::exception&) {
    const std::string tool = base_name(argc > 0 ? argv[0] : "krok");
    write_message(nullptr, message_of(tool, error_of_exception(tool)));
    return kExitTrouble;
  }
}

}  // namespace krok::cli
