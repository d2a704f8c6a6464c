#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/common/console_progress.h"
#include "tools/common/tool.h"

// What is written on a command line, or on a line of a list of files, declared and parsed.

namespace krok {

// An option that was given, as it was written. A flag's value is "true".
struct GivenOption {
  std::string name;  // without dashes
  std::vector<std::string> values;
  bool is_flag = false;
  bool names_input = false;   // IN... in the help
  bool names_output = false;  // OUT... in the help
};

// The arguments that give these options again.
std::vector<std::string> arguments_of(const std::vector<GivenOption>& options);

class CommandLine {
 public:
  enum class Form {
    single,    // one input, one output
    many,      // many inputs, --out-dir or --manifest
    own,       // the tool's own options alone, none required: a line of a manifest
    one_file,  // the tool's own options and positionals, and -o: one file of many
  };
  enum class Wish { run, help, version };

  CommandLine(const ToolSpec& spec, Form form);
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // Can be called again with the same options and other values: what is not given then keeps its
  // value. An Error has the code usage.
  Result<Wish> parse(const std::vector<std::string>& arguments);

  std::string help() const;

  // The tool's own options that were given, in the order of their declaration.
  const std::vector<GivenOption>& given() const { return given_; }

  // A context with what was given; the names of the results are its destinations.
  ToolContext context() const;

  // Form many: the last positional, again and again, and what stands before.
  std::vector<std::string> inputs;
  std::vector<std::string> fixed_positionals;

  // The common options.
  std::string output;
  std::string json_path;  // "-" is standard output
  ProgressStyle style = ProgressStyle::automatic;
  int jobs = 0;
  bool no_clobber = false;
  bool quiet = false;
  bool verbose = false;

  // The options for many files.
  std::string out_dir;
  std::string base;
  std::string manifest;
  std::string shard;
  bool keep_going = false;
  bool force = false;

 private:
  void take_many_inputs();
  void declare_common(const ToolSpec& spec);
  void declare_for_many();
  void remember_values();
  void note_given();
  Status check_use_of_batch_options() const;

  Form form_;
  // Keeps alive what the options of app_ write to.
  std::function<void(CommandOptions&)> declare_;
  CLI::App app_;
  CommandOptions options_{app_};
  CLI::Option* inputs_option_ = nullptr;
  std::vector<CLI::Option*> own_options_;
  // What the user gave for each option, before CLI11 replaces it ("xyzw") by what it stands for
  // ("1").
  std::map<const CLI::Option*, std::vector<std::string>> written_;
  std::vector<GivenOption> given_;
  std::string tool_;
  bool takes_many_ = false;
};

}  // namespace krok
