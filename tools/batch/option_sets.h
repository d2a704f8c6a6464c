#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "tools/cli/command_line.h"
#include "tools/cli/tool.h"

// A manifest lists the files of a batch: one file per line, with tab-separated fields input, output
// and options. Output and options are optional. Empty lines and lines that begin with # are
// ignored, as is a header line of the three field names. Options are separated by spaces; single or
// double quotes enclose an option with spaces.

namespace krok::cli::batch {

struct ManifestWord {
  std::string text;
  Location where;
};

struct ManifestLine {
  ManifestWord input;
  ManifestWord output;  // empty text if missing
  std::vector<ManifestWord> options;
};

struct Manifest {
  std::vector<ManifestLine> lines;
  Diagnostics errors;  // each with its location; code manifest-line
};

Manifest parse_manifest(std::string_view text, const std::string& file_name);

// A set of options shared by files of a batch.
struct OptionSet {
  std::vector<GivenOption> options;
  Result<std::string> ending = std::string();  // suffix of output names, or why it is unknown
  bool each_animation = true;                  // of an input is a file
};

// The options of the command line merged with those of manifest lines, which override them. Each
// distinct set is parsed once.
class OptionSets {
 public:
  OptionSets(MakeToolSpec make_spec, const CommandLine& whole);

  // Index of the set for these manifest words. An Error has the location of the invalid word, or no
  // file if there are no words.
  Result<std::size_t> find(const std::vector<ManifestWord>& words);

  std::vector<OptionSet> take() && { return std::move(sets_); }
  const std::vector<OptionSet>& all() const { return sets_; }

 private:
  Result<OptionSet> parse(const std::vector<std::string>& words) const;

  MakeToolSpec make_spec_;
  std::vector<GivenOption> whole_;
  std::vector<std::string> fixed_positionals_;
  std::vector<OptionSet> sets_;
  std::map<std::vector<std::string>, std::size_t> known_;
};

// The arguments for one file.
std::vector<std::string> arguments_for_file(const std::vector<GivenOption>& options,
                                            const std::vector<std::string>& fixed_positionals,
                                            const std::string& input, const std::string& output,
                                            bool no_clobber);

// Pool of command lines, each ready to parse one file of a batch. Declaring options is slower than
// parsing them, so files with the same option set reuse a line. Sets must not be mixed: an option
// that is not given keeps its previous value. Running a tool does not change its options.
class ReadyLines {
 public:
  // Keeps at most `max` lines, one per thread, for any number of option sets.
  ReadyLines(MakeToolSpec make_spec, std::size_t max)
      : make_spec_(std::move(make_spec)), max_(max) {}

  // Takes a line for an option set. Thread-safe, as is put_back().
  std::unique_ptr<CommandLine> take(std::size_t set);
  void put_back(std::size_t set, std::unique_ptr<CommandLine> line);

 private:
  struct Kept {
    std::size_t set;
    std::unique_ptr<CommandLine> line;
  };
  MakeToolSpec make_spec_;
  std::size_t max_;
  std::mutex mutex_;
  std::vector<Kept> kept_;  // most recently returned last
};

}  // namespace krok::cli::batch
