#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/file.h"
#include "core/progress.h"
#include "core/result.h"
#include "scene/provenance.h"
#include "tools/common/command_options.h"
#include "tools/common/report.h"

// The frame that all tools share: options, help, messages, exit codes, the report, and the same
// work on many files. A tool declares its own options in a function and does its work in another;
// its main is one call of run_tool.

namespace krok {

class Console;

inline constexpr int kExitDone = 0;     // done, or "the same"
inline constexpr int kExitNo = 1;       // the answer is no: a difference, a failed check
inline constexpr int kExitTrouble = 2;  // usage, input, output
inline constexpr int kExitPartly = 3;   // a batch ended with some files failed

// What a tool's work is given: the common options, and the places for what it has to say.
class ToolContext {
 public:
  int jobs = 0;             // -j; 0 is one thread a core
  bool no_clobber = false;  // --no-clobber
  bool quiet = false;       // -q
  bool verbose = false;     // -v
  std::string output;       // -o, empty where none was given
  Progress* progress = nullptr;
  Report report;

  // The files that this run writes: -o, --json=FILE and every option whose value is named OUT... in
  // the help. open_input refuses to read one of them.
  std::vector<std::string> destinations;
  // Where the report goes: --json=FILE, "-", or empty.
  std::string report_path;
  // Inputs that a result would have replaced. No report is written there either.
  std::vector<std::string> refused_inputs;

  // The options given that change the result, for provenance: without those that name outputs, and
  // inputs (named IN... in the help) by base name, so that no folder gets into a result.
  Json result_options = Json::object();

  // Prints a diagnostic in the common form on standard error (notes with -v only, with -q errors
  // only), after the tool's name where it is about no file, and keeps it in the report.
  void tell(Diagnostic diagnostic);
  void tell(const Diagnostics& diagnostics);
  void warn(std::string code, std::string message, std::string hint = {});

  // A line for people about what was done, on standard error, not with -q or with --json to
  // standard output. Of many files, with -v only.
  void say(const std::string& line);

  // Data for people or pipes on standard output; suppressed where the report goes there.
  void print(const std::string& text);

  // Opens an input and records its path and checksum in the report. Refuses (code usage) a file
  // that this run writes too, for a capture would be lost, and standard input for the second time.
  // Every file that the result depends on is to be opened by this: it is how a batch knows that
  // nothing changed.
  Result<InputFile> open_input(const std::string& path);

  // The same for a long file that is read from front to back: its checksum is taken on the way
  // rather than first, and is in the report only once note_checksum() was called; which must be
  // before provenance() and the end of the run.
  Result<InputFile> open_long_input(const std::string& path);
  void note_checksum(const InputFile& input);

  // Notes that the result depends on which files with this ending, ".asf", or of this whole name,
  // "walk.keys.json", stand beside `path`: when one comes or goes, a batch does the file anew.
  void chose_beside(const std::string& path, const std::string& ending);

  // Whether a result may go to `path`: an Error (code usage) for a file that this run reads, its
  // report, what it writes already and, in a batch, files that the batch reads or other files of it
  // are to become. Results are written by write_output or an OutputSet (output_set.h), which ask.
  Status check_output(const std::string& path);
  // Whether `path` is one of the destinations, as written there: other results have names that the
  // input or an option's file tells.
  bool is_destination(const std::string& path) const;

  // The options for writing a file, and a note of it in the report; call before writing.
  OutputFile::Options output_options() const {
    return {.no_clobber = no_clobber, .stored_later = kept_messages != nullptr};
  }
  void wrote(const std::string& path);

  // Provenance of a result: this tool, its version, the inputs opened so far by base name, the
  // options given that change the result, the warnings told so far.
  Provenance provenance() const;

  bool report_on_standard_output = false;
  Console* console = nullptr;  // where messages go; standard error if null

  // One file of many: its messages are kept here, to be told in the order of the list, ...
  std::string* kept_messages = nullptr;
  // ... and what is about no file in particular is about this one.
  Location subject;
  // What the batch says to a result that is no destination, and ...
  std::function<Status(const std::string& path)> check_unforeseen;
  // ... those results, which the batch puts in place.
  std::vector<OutputFile> held_files;
  std::vector<std::string> held_paths;

 private:
  void put_message(const std::string& text);

  std::set<std::string> written_;  // places that check_output let pass
};

struct ToolSpec {
  struct Example {
    std::string command;
    std::string does;
  };
  // For a tool that makes one result of one input: it then takes many, see tools/common/batch.h.
  // The input is the last positional; those before it, if any, are the same for all files.
  struct Batch {
    // Extensions of the files that a folder given as input stands for: {".bvh", ".amc"}.
    std::vector<std::string> reads;
    // How the name of a result ends where its input has an extension, ".anim" or "_{clip}.anim";
    // asked once the options are parsed, and an Error (code
    // usage) where they do not tell.
    std::function<Result<std::string>()> ending;
  };
  std::string name;                // "krok-import"
  std::string summary;             // a sentence without a full stop
  std::string inputs;              // for the usage line: "IN.bvh"
  std::vector<Example> examples;   // at least two
  std::string exit_done = "done";  // what exit code 0 means here
  std::string exit_no;             // what exit code 1 means here; empty where it does not happen
  std::string exit_partly;         // what exit code 3 means to a tool without a Batch, or empty
  std::string report_name;         // another name of --json, "--report", or empty
  bool has_output = true;          // takes -o
  bool needs_output = true;        // -o must be given
  std::optional<Batch> batch;

  // Adds the tool's own options and positionals.
  std::function<void(CommandOptions&)> declare;
  // Whether the options, which are parsed, have values that fit some file or other; may be empty.
  // Asked before any file is opened, of a batch once for each set of options.
  std::function<Status()> check;
  // Does the work; the value is an exit code, an Error becomes a message and kExitTrouble.
  std::function<Result<int>(ToolContext&)> run;
};

// Gives a ToolSpec whose functions share options of their own (a std::shared_ptr), so that each
// file of a batch is parsed for and run by itself, several at once.
using MakeToolSpec = std::function<ToolSpec()>;

// A Batch's `ending` for a tool whose results all have the same one.
std::function<Result<std::string>()> always(std::string ending);

// Parses, runs, reports. Catches everything that is thrown (memory exhausted, a bug) and turns it
// into a message and kExitTrouble.
int run_tool(const MakeToolSpec& make_spec, int argc, char** argv);
// For a tool that takes no batches.
int run_tool(const ToolSpec& spec, int argc, char** argv);

// Prints on standard output and gives the exit code: kExitTrouble with a message where it cannot be
// written.
int print_and_end(const std::string& tool, const std::string& text);

// The work alone, with whatever is thrown as an Error (out-of-memory, internal).
Result<int> run_guarded(const ToolSpec& spec, ToolContext& context);

// The version of the project, "0.1.0".
std::string version();

}  // namespace krok
