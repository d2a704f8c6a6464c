#include "tools/common/tool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <memory>
#include <new>

#include "tools/common/batch.h"
#include "tools/common/command_line.h"
#include "tools/common/console_progress.h"
#include "tools/common/paths.h"

namespace krok {

namespace {

// A program may be started with standard streams closed. The next file opened would take their
// place, and messages would be written into it.
void open_missing_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) < 0) (void)::open("/dev/null", O_RDWR);
  }
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
    write_message(context.console, to_text(written.error()) + "\n");
    return kExitTrouble;
  }
  return exit_code;
}

int fail(ToolContext& context, const std::string& json_path, const Error& error) {
  context.tell(error);
  return finish(context, json_path, kExitTrouble);
}

bool standard_output_written() {
  return std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
}

Error standard_output_error() {
  return Error("file-unwritable", "standard output cannot be written", "check where it goes");
}

int print_and_end(const std::string& tool, const std::string& text) {
  (void)std::fwrite(text.data(), 1, text.size(), stdout);
  if (standard_output_written()) return kExitDone;
  write_message(nullptr, message_of(tool, standard_output_error()));
  return kExitTrouble;
}

int run_single(const ToolSpec& spec, const CommandLine& line) {
  ToolContext context = line.context();
  if (context.report_on_standard_output && context.output == "-") {
    return fail(context, "",
                Error("usage", "the report and the output cannot both go to standard output",
                      fmt::format("see {} --help", spec.name)));
  }
  if (Status apart = check_destinations(context); !apart) return fail(context, "", apart.error());
  const bool silent = context.quiet && line.style == ProgressStyle::automatic;
  const auto console = console_progress(silent ? ProgressStyle::none : line.style);
  context.console = console.get();
  context.progress = console.get();
  const Result<int> done = run_guarded(spec, context);
  console->end();
  if (!done) return fail(context, line.json_path, done.error());
  if (!standard_output_written()) return fail(context, line.json_path, standard_output_error());
  return finish(context, line.json_path, *done);
}

}  // namespace

std::string version() {
  return KROK_VERSION;
}

std::function<Result<std::string>()> always(std::string ending) {
  return [ending = std::move(ending)] { return ending; };
}

Result<int> run_guarded(const ToolSpec& spec, ToolContext& context) {
  try {
    return spec.run(context);
  } catch (const std::bad_alloc&) {
    return Error("out-of-memory", "there is not enough memory");
  } catch (const std::exception& error) {
    return Error("internal", fmt::format("a bug in {}: {}", spec.name, error.what()),
                 "please report it with the input that caused it");
  }
}

int run_tool(const MakeToolSpec& make_spec, int argc, char** argv) {
  open_missing_standard_streams();
  remove_temporaries_on_signals();
  const ToolSpec spec = make_spec();
  const std::vector<std::string> arguments = arguments_of(argc, argv);
  const bool many = spec.batch && is_for_many(arguments);
  CommandLine line(spec, many ? CommandLine::Form::many : CommandLine::Form::single);
  const auto wish = line.parse(arguments);
  if (!wish) {
    ToolContext context;
    context.report.tool = spec.name;
    context.report.version = version();
    std::string path = report_path(arguments);
    if (many && !only_a_report_stands_at(path)) path.clear();  // a pattern may stand for it
    return fail(context, path, wish.error());
  }
  if (*wish == CommandLine::Wish::version) {
    return print_and_end(spec.name, fmt::format("{} {}\n", spec.name, version()));
  }
  // Without the changes for many files, whatever else was given.
  if (*wish == CommandLine::Wish::help) {
    return print_and_end(spec.name, CommandLine(spec, CommandLine::Form::single).help());
  }
  return many ? run_batch(make_spec, line) : run_single(spec, line);
}

int run_tool(const ToolSpec& spec, int argc, char** argv) {
  return run_tool([&spec] { return spec; }, argc, argv);
}

}  // namespace krok
