#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "formats/io/inputs.h"
#include "formats/registry/registry.h"
#include "scene/provenance.h"
#include "tools/cli/command_options.h"
#include "tools/cli/console_progress.h"
#include "tools/cli/option_search.h"
#include "tools/cli/report.h"

// The framework of all tools: options, help, messages, exit codes, the report and batch mode. A
// tool has one function that declares its options and one that does the work; its main() is a call
// of run_tool.

namespace krok::cli {

class CommandLine;
class Console;

inline constexpr int kExitDone = 0;     // success, or "equal"
inline constexpr int kExitNo = 1;       // negative result: a difference, a failed check
inline constexpr int kExitTrouble = 2;  // usage, input or output error
inline constexpr int kExitPartly = 3;   // batch finished, some files failed

// How the run for one of many files (batch mode, folders of krok-diff) differs from a single run.
struct OneOfMany {
  struct Message {
    std::string text;
    std::string code;  // of a warning or an error; empty for what is always shown
  };
  std::vector<Message> messages;  // collected, to be printed in list order
  // Checks an output that is not a destination; may be empty. Those outputs are held back here, and
  // renamed to their final names in list order.
  std::function<Status(const std::string& path)> check_unforeseen;
  std::vector<OutputFile> held_files;
  std::vector<std::string> held_paths;
};

// Passed to a tool's run function: the common options, messages and the report.
class ToolContext : public io::Inputs {
 public:
  bool no_clobber = false;  // --no-clobber
  bool quiet = false;       // -q
  bool verbose = false;     // -v
  std::string output;       // -o, empty if not given
  Report report;

  // The files that this run writes: -o, --json=FILE and every option whose value is named OUT... in
  // the help. open_input rejects them.
  std::vector<std::string> destinations;
  bool keep_going = false;              // see leave_out()
  std::set<std::string> left_out = {};  // inputs
  bool of_folder = false;               // whether the inputs were given as a folder
  // Report path: --json=FILE, "-", or empty.
  std::string report_path;
  // Outputs of a single run that wait for its report; all are put in place together.
  std::vector<OutputFile> files_with_report;
  std::vector<std::string> lines_with_report;  // of log(), since then
  // Inputs that an output would have overwritten. The report must not overwrite them either.
  std::vector<std::string> refused_inputs;

  // The given options that affect the result, for provenance. Options that name outputs are left
  // out; inputs (named IN... in the help) are reduced to base names, so that no folder gets into a
  // result.
  Json result_options = Json::object();

  // Prints a diagnostic on standard error (notes only with -v, only errors with -q, without -v at
  // most 20 warnings or errors with one code, and those of three files), prefixed with the tool's
  // name if it has no file, and adds it to the report.
  void diagnose(Diagnostic diagnostic) override;
  // Prints how many files had messages that were not printed.
  void end_messages();
  using io::Inputs::diagnose;
  void warn(std::string code, std::string message, std::string hint = {});

  // For an input, one of `inputs` for one output, that cannot be used: fails with its error, or
  // warns with --keep-going, for exit code 3. An output of nothing is for the caller to refuse.
  Status leave_out(const std::string& path, Error error, std::size_t inputs);

  // Prints a status line on standard error; not with -q or with --json to standard output. In batch
  // mode only with -v. Lines that follow outputs are held back with those.
  void log(const std::string& line);

  // Prints data on standard output; suppressed if the report goes there.
  void print(const std::string& text);

  // Opens an input and records its path and checksum in the report. Fails (code usage) for a file
  // that this run also writes, as that would destroy the input, and for standard input opened a
  // second time. Open every file that the result depends on with this: a batch uses the record to
  // detect changed inputs.
  Result<InputFile> open_input(const std::string& path) override;

  // The same for a long file that is read sequentially: its checksum is computed while reading and
  // added to the report by note_checksum(), which must be called before provenance() and the end of
  // the run.
  Result<InputFile> open_long_input(const std::string& path) override;
  void note_checksum(const InputFile& input) override;

  // The context of a file that is read beside others, on any thread: with the same limits and
  // destinations, silent (`messages` gets what it would print), and with a report of its own, which
  // is for the caller to add in the order of the files.
  ToolContext beside(OneOfMany& messages, int threads) const;

  // Records that the result depends on which files with this suffix, ".asf", or of this full name,
  // "walk.keys.json", exist beside `path`: a batch processes the file again if one is added or
  // removed.
  void depends_on_neighbours(const std::string& path, const std::string& ending) override;

  // Whether an output may be written to `path`: fails (code usage) for an input of this run, its
  // report, a path already written and, in a batch, for inputs of the batch and outputs of other
  // files. Called by write_output and OutputSet (output_set.h), which write all outputs.
  Status check_output(const std::string& path);
  // Whether `path` is literally one of the destinations. Names of other outputs come from the input
  // or from a file that an option names.
  bool is_destination(const std::string& path) const;

  // Options for writing an output file.
  OutputFile::Options output_options() const {
    return {.no_clobber = no_clobber, .stored_later = one_of_many != nullptr};
  }
  void wrote(const std::string& path);

  // Provenance of a result: this tool, its version, base names of the inputs opened so far, the
  // given options that affect the result, the warnings so far.
  Provenance provenance() const;

  bool report_on_standard_output = false;
  Console* console = nullptr;  // for messages; standard error if null

  OneOfMany* one_of_many = nullptr;  // null for a single run
  // The location of diagnostics that have none.
  Location subject;

 private:
  void put_message(const std::string& text, const std::string& code = {});

  AlikeMessages by_file_;             // of a single run
  std::map<std::string, int> alike_;  // warnings and errors so far, by code
  std::set<std::string> said_;        // warnings so far
  std::set<std::string> written_;     // canonical paths that passed check_output
};

// While it lives, the reading of a file shows no progress: for tools that count the files.
class HiddenProgress {
 public:
  explicit HiddenProgress(ToolContext& context)
      : context_(context), hidden_(std::exchange(context.progress, nullptr)) {}
  ~HiddenProgress() { context_.progress = hidden_; }
  HiddenProgress(const HiddenProgress&) = delete;
  HiddenProgress& operator=(const HiddenProgress&) = delete;

 private:
  ToolContext& context_;
  Progress* hidden_;
};

struct ToolSpec {
  struct Example {
    std::string command;
    std::string does;
  };
  // For a tool with one input and one output that also runs in batch mode (tools/batch). The input
  // is the last positional; those before it, if any, are shared by all files.
  struct Batch {
    // Extensions of the files taken from an input folder: {".bvh", ".amc"}.
    std::vector<std::string> reads;
    // Suffix of output names that replaces the input's extension, ".anim" or "_{clip}.anim". Called
    // after the options are parsed; an Error (code usage) if they do not determine it.
    std::function<Result<std::string>()> ending;
    // Whether each animation of an input is a file of the batch. None: yes.
    std::function<bool()> each_animation = {};
  };
  std::string name;     // "krok-import"
  std::string summary;  // in a line of 75 characters, no full stop; krok --help has it, too
  std::string details;  // sentences that follow it in the help, or empty
  std::string inputs;   // for the usage line: "IN.bvh"
  std::vector<Example> examples;            // at least two
  std::string exit_done = "done";           // meaning of exit code 0
  std::string exit_no;                      // meaning of exit code 1; empty if never returned
  std::string exit_partly;                  // meaning of exit code 3 without a Batch, or empty
  std::string report_name;                  // alias of --json, "--report", or empty
  bool has_output = true;                   // has -o
  bool needs_output = true;                 // -o is required
  bool keeps_going = false;                 // --keep-going also of many inputs for one output
  std::optional<registry::Kind> writes;     // what -o is, if it is always the same
  std::vector<std::string> output_endings;  // that -o may have, of what is no Kind; none: any
  // Where the output goes without -o, after the options are parsed: "" for nowhere. No file there
  // is replaced. May be empty.
  std::function<std::string()> default_output;
  std::optional<Batch> batch;
  // In a list of inputs, and without a Batch, a folder stands for all its files with one of these
  // endings, sub-folders included. None: it is a file that cannot be read.
  std::vector<std::string> folder_endings;
  // Where a folder is all files in it: whether each animation of a file is an input of its own
  // (FILE#ANIMATION), for this output. Called after the options are parsed. None: no.
  std::function<bool(const std::string& output)> each_animation;

  // The options of all tools, for whoever gives one to another; may be empty.
  std::function<std::vector<ToolOption>()> options_of_all;

  // Adds the tool's own options and positionals.
  std::function<void(CommandOptions&)> declare;
  // Checks the parsed options for values that are invalid for any file; may be empty. Called before
  // any file is opened, in a batch once for each set of options.
  std::function<Status()> check;
  // Does the work. Returns an exit code; an Error is printed and becomes kExitTrouble.
  std::function<Result<int>(ToolContext&)> run;
};

// Creates a ToolSpec whose functions share their own options (a std::shared_ptr), so that the files
// of a batch can be parsed and run independently and in parallel.
using MakeToolSpec = std::function<ToolSpec()>;

// A spec whose functions share `options`. `check` may be null.
template <typename Options>
ToolSpec spec_of(std::string name, const std::shared_ptr<Options>& options,
                 void (*declare)(CommandOptions&, Options&), Status (*check)(const Options&),
                 Result<int> (*run)(const Options&, ToolContext&)) {
  ToolSpec spec;
  spec.name = std::move(name);
  spec.declare = [options, declare](CommandOptions& command) { declare(command, *options); };
  if (check != nullptr) spec.check = [options, check] { return check(*options); };
  spec.run = [options, run](ToolContext& context) { return run(*options, context); };
  return spec;
}

// A Batch::ending that is the same for all outputs.
std::function<Result<std::string>()> always(std::string ending);

// Takes over command lines that name many files; batch::run_tool passes one.
struct ManyFiles {
  std::function<bool(const std::vector<std::string>& arguments)> asked_for;
  std::function<int(const MakeToolSpec&, const CommandLine&)> run;
};

// Parses, runs, reports. Catches all exceptions (out of memory, bugs) and turns them into a message
// and kExitTrouble.
int run_tool(const MakeToolSpec& make_spec, int argc, char** argv, const ManyFiles& many = {});

// Prints on standard output and returns the exit code: kExitTrouble with a message if writing
// fails.
int print_and_end(const std::string& tool, const std::string& text);

// Calls spec.run and turns exceptions into Errors (out-of-memory, internal).
Result<int> run_guarded(const ToolSpec& spec, ToolContext& context);

// The version of the project, "0.2.0".
std::string version();
// The same for people: "0.2.0 (5599e605 with uncommitted changes)".
std::string version_of_build();

}  // namespace krok::cli
