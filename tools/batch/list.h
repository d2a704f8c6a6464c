#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/batch/option_sets.h"
#include "tools/cli/command_line.h"
#include "tools/cli/paths.h"
#include "tools/cli/tool.h"

namespace krok::cli::batch {

// One file of a batch.
struct BatchFile {
  std::string input;
  std::string name;         // value of {name}, "a/walk"
  std::string key;          // output relative to the output folder, "a/walk.anim"
  std::string output;       // output path
  std::size_t options = 0;  // index into BatchList::option_sets
  Location line;            // in the manifest; no file without one
  bool found = false;       // in a folder or by a pattern, not named
};

struct BatchList {
  std::vector<OptionSet> option_sets;
  std::vector<BatchFile> files;                  // of this shard
  std::size_t total = 0;                         // in all shards
  std::map<FileNumber, std::string> read_files;  // inputs of all shards, maps, the list itself
  Diagnostics left_out;                          // for each folder, what the tool does not read
};

// Expands the path in an option that names an output: "{name}" is replaced by BatchFile::name, and
// relative paths are relative to the output folder.
std::string expanded(const std::string& value, const BatchFile& file, const std::string& out_dir);

// A file's options with output paths expanded.
std::vector<GivenOption> options_of(const BatchFile& file, const BatchList& list,
                                    const std::string& out_dir);

// Builds the list of files of a command line and checks it: no two outputs are the same file, none
// overwrites an input. Problems are added to `errors`; the list is then unusable. Reads the
// manifest and searches for files, but opens none of them.
BatchList list_files(const CommandLine& line, const MakeToolSpec& make_spec, Diagnostics& errors);

// Checks that no two outputs of a batch (including those that options name) are the same file, and
// that none overwrites an input, the manifest or the report. Adds problems to `errors` (code
// usage). Fills in list.read_files.
void check_batch(const CommandLine& line, BatchList& list, Diagnostics& errors);

}  // namespace krok::cli::batch
