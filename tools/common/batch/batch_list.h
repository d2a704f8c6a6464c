#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/common/batch/option_sets.h"
#include "tools/common/command_line.h"
#include "tools/common/paths.h"
#include "tools/common/tool.h"

namespace krok {

// One file of a batch.
struct BatchFile {
  std::string input;
  std::string name;         // what {name} stands for, "a/walk"
  std::string key;          // the output below the output folder, "a/walk.anim"
  std::string output;       // the output as a path
  std::size_t options = 0;  // which of BatchList::option_sets
  Location line;            // in the manifest; no file where there is none
};

struct BatchList {
  std::vector<OptionSet> option_sets;
  std::vector<BatchFile> files;                  // those of this shard
  std::size_t total = 0;                         // in all shards
  std::map<FileNumber, std::string> read_files;  // inputs of all shards, maps, the list itself
};

// The path in an option that names an output: "{name}" in it stands for the file's output below the
// output folder without its ending, and a relative path is below the output folder too.
std::string expanded(const std::string& value, const BatchFile& file, const std::string& out_dir);

// A file's options with the names of outputs expanded.
std::vector<GivenOption> options_of(const BatchFile& file, const BatchList& list,
                                    const std::string& out_dir);

// The list of files that the command line asks for, checked as a whole: no two results share a
// file, none replaces an input. What is wrong is added to `errors`, and then the list is of no use.
// Reads the manifest and looks for files; opens none of them.
BatchList list_files(const CommandLine& line, const MakeToolSpec& make_spec, Diagnostics& errors);

}  // namespace krok
