#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/child_process.h"
#include "core/result.h"
#include "tools/cli/console_progress.h"
#include "tools/cli/tool.h"

// Declares and parses a command line or a manifest line.

namespace krok::cli {

// An option as the user wrote it. A flag's value is "true".
struct GivenOption {
  std::string name;  // without dashes
  std::vector<std::string> values;
  bool is_flag = false;
  bool names_input = false;   // IN... in the help
  bool names_output = false;  // OUT... in the help
};

// Arguments that parse to these options.
std::vector<std::string> arguments_of(const std::vector<GivenOption>& options);

class CommandLine {
 public:
  enum class Form {
    single,    // one input, one output
    many,      // batch mode: --out-dir or --manifest
    own,       // only the tool's own options, none required: a manifest line
    one_file,  // the tool's own options and positionals, and -o: one file of a batch
  };
  enum class Wish { run, help, version };

  CommandLine(ToolSpec spec, Form form);
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // May be called again with the same options and other values; options that are not given keep
  // their value. Errors have the code usage.
  Result<Wish> parse(const std::vector<std::string>& arguments);

  std::string help() const;
  // What fits on a screen: usage, names of options by group, examples.
  std::string short_help() const;

  // The same arguments with each positional that is a pattern, which the shell did not expand,
  // replaced by the files that it matches; a pattern without a match is left. After parse().
  std::vector<std::string> expanded(const std::vector<std::string>& arguments) const;

  // The tool, whose functions share the options that parse() sets.
  const ToolSpec& spec() const { return spec_; }

  // What completion in shells needs to know.
  std::vector<OptionFacts> options() const { return options_.facts(); }

  // The tool's own options that were given, in declaration order.
  const std::vector<GivenOption>& given() const { return given_; }

  // Of --limit-time and --limit-memory.
  GivenLimits limits() const;

  // A context with the given options; the output names are its destinations.
  ToolContext context() const;

  // Form many: all values of the last positional, and the positionals before it.
  std::vector<std::string> inputs;
  std::vector<std::string> fixed_positionals;

  // What was left out of folders that were given as inputs.
  Diagnostics left_out;
  // Whether a folder was.
  bool of_folder = false;

  // The common options.
  std::string output;
  bool output_is_default = false;  // that of ToolSpec::default_output
  std::string json_path;           // "-" is standard output
  ProgressStyle style = ProgressStyle::automatic;
  int jobs = 0;
  std::optional<double> limit_seconds;
  std::optional<int> limit_mebibytes;
  bool no_clobber = false;
  bool quiet = false;
  bool verbose = false;

  // Batch options.
  std::string out_dir;
  std::string base;
  std::string manifest;
  std::string shard;
  bool keep_going = false;
  bool force = false;

 private:
  // Sets up the layout of --help: usage, option groups, examples, exit codes.
  void shape_help();
  void take_many_inputs();
  void declare_common();
  void declare_for_many();
  void declare_keep_going(const char* help);
  void note_given();
  Status open_folders();
  Status check_use_of_batch_options() const;
  std::optional<Error> option_without_value(const std::vector<std::string>& arguments) const;
  std::optional<Error> option_with_one_dash(const std::vector<std::string>& arguments) const;
  std::optional<Error> unknown_option(const std::string& argument) const;
  std::optional<Error> unknown_options(const std::vector<std::string>& arguments) const;
  std::string options_like(const std::string& name) const;
  std::string names_of_own_options() const;
  std::optional<Error> json_file_apart(const std::vector<std::string>& arguments) const;
  std::optional<Error> value_of_flag(const std::vector<std::string>& arguments,
                                     const std::string& word) const;
  std::optional<Error> value_in_pieces(const std::vector<std::string>& arguments) const;
  Error parse_error(const std::vector<std::string>& arguments, const CLI::ParseError& error) const;

  Form form_;
  ToolSpec spec_;
  CLI::App app_;
  CommandOptions options_{app_};
  CLI::Option* inputs_option_ = nullptr;
  std::vector<CLI::Option*> own_options_;
  std::vector<GivenOption> given_;
};

}  // namespace krok::cli
