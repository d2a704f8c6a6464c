#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "tools/common/report.h"

// What batches have done in a folder, so that the next one need not do it again. A text file that
// stands there, TOOL.journal.jsonl (of a shard TOOL.2-of-4.journal.jsonl), with an object a line
// for each result:
//
//   {"output": "a/walk.anim", "made_with": "16 digits", "version": "0.1.0", "input":
//   "takes/walk.bvh",
//    "inputs": [{"path", "xxh3"}], "choices": [{"folder", "ending", "xxh3"}],
//    "outputs": [{"path", "size", "xxh3"}], "issues": [], "result": {}}
//
// "output" and the paths in "outputs" are below the folder; "made_with" is a checksum of all that
// makes a result besides the inputs' bytes; a choice is of the files with that ending, or of that
// name, in that folder, its checksum one of their names and sizes. A line is written whole when a
// result is whole on the disk, so that a killed run loses at most the line that it was at; what is
// no whole line is passed over. Nothing is believed: a result counts as done only while all its
// files and all its inputs have the checksums that stand there. A lost or wrong line costs time,
// never a result.

namespace krok {

class Journal {
 public:
  // Reads all of the tool's journals in `folder`, its shards' too, for later look-ups; `suffix` is
  // empty or ".2-of-4", of the one to write. A folder or journal that is not there is an empty one.
  Journal(const std::string& folder, const std::string& tool, const std::string& suffix);
  ~Journal();

  // The record of `output`, made by `made_with` from `input`, if everything in it still holds. Can
  // be called from several threads.
  std::optional<Json> unchanged(const std::string& output, const std::string& made_with,
                                const std::string& input) const;

  // Adds a record, and puts it on the disk's way. Can be called from several threads.
  Status add(const Json& record);

  // Once all is done: the newest line for each output, sorted, so that the journal does not grow
  // from run to run or depend on the order in which threads were done. Leaves a journal alone to
  // which nothing was added. Does not wait for the disk; store_files() does. Nothing can be looked
  // up any more.
  Status tidy();

  const std::string& path() const { return path_; }

 private:
  struct LineRange {
    std::size_t file;
    std::size_t begin, size;
  };
  using Index = std::unordered_map<std::string, std::vector<LineRange>>;

  void read(const std::string& path);
  std::string output_of(std::string_view line) const;
  std::string_view line(const LineRange& place) const;
  Result<std::string> checksum_of_input(const std::string& path) const;
  std::string checksum_of_choice(const std::string& folder, const std::string& ending) const;

  std::string folder_;
  std::string path_;
  std::vector<InputFile> files_;
  Index index_;
  std::unordered_map<std::uint64_t, std::string> added_outputs_;  // by the checksums of lines
  int descriptor_ = -1;
  std::mutex adding_;
  mutable std::mutex checking_;
  mutable std::map<std::string, std::string> input_checksums_;  // of files that many results share
  mutable std::map<std::pair<std::string, std::string>, std::string> choice_checksums_;
};

// A record of a result: the checksums of its files are taken from the disk; of those in `places`,
// which are not in place yet, from where it says. Takes the report's `result`.
Result<Json> journal_record(const std::string& folder, const std::string& output,
                            const std::string& made_with, const std::string& input, Report& report,
                            const std::map<std::string, std::string>& places);

}  // namespace krok
