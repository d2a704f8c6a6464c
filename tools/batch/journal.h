#pragma once

#include <array>
#include <cstddef>
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
#include "tools/cli/report.h"

// The journal of the batches run in an output folder, for incremental runs. A text file in that
// folder, TOOL.journal.jsonl (for a shard TOOL.2-of-4.journal.jsonl), with one JSON object per line
// and output:
//
//   {"output": "a/walk.anim", "made_with": "16 digits", "version": "0.2.0", "input":
//   "takes/walk.bvh",
//    "inputs": [{"path", "xxh3"}], "choices": [{"folder", "ending", "xxh3"}],
//    "outputs": [{"path", "size", "xxh3"}], "issues": [], "result": {}}
//
// "output" and the paths in "outputs" are relative to the folder. "made_with" is a checksum of
// everything except the inputs' bytes that determines the output. A choice covers the files with
// that suffix, or of that name, in a folder; its checksum is of their names and sizes. A line is
// appended after the output is written, so a killed run loses at most one line; incomplete lines
// are ignored. An output is up to date only if all its files and inputs match the recorded
// checksums; a missing or wrong line only causes extra work.

namespace krok::cli::batch {

class Journal {
 public:
  // Reads all of the tool's journals in `folder`, including those of shards. `suffix` is that of
  // the journal to write, empty or ".2-of-4". A missing folder or journal counts as empty.
  Journal(const std::string& folder, const std::string& tool, const std::string& suffix);
  ~Journal();

  // The record of `output`, made with `made_with` from `input`, if it is still up to date.
  // Thread-safe.
  std::optional<Json> unchanged(const std::string& output, const std::string& made_with,
                                const std::string& input) const;

  // Appends a record to the file, without waiting for the disk. Thread-safe.
  Status add(const Json& record);

  // Call at the end of a run. Rewrites the journal with the newest line for each output, sorted, so
  // that it neither grows with each run nor depends on thread timing. Does nothing if nothing was
  // added. Does not wait for the disk; store_files() does. No look-ups are possible afterwards.
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
  std::unordered_map<std::uint64_t, std::string> added_outputs_;  // keyed by checksum of the line
  int descriptor_ = -1;
  std::mutex adding_;
  mutable std::mutex checking_;
  mutable std::map<std::string, std::string> input_checksums_;  // of shared inputs
  mutable std::map<std::pair<std::string, std::string>, std::string> choice_checksums_;
};

// Creates the record of an output, with checksums of its files on disk. `places` maps files that
// still have a temporary name to that name. Moves from the report's `result`.
Result<Json> journal_record(const std::string& folder, const std::string& output,
                            const std::string& made_with, const std::string& input, Report& report,
                            const std::map<std::string, std::string>& places);

// Status of a processed file of a batch.
enum class FileState {
  done,
  unchanged,
  left_out,  // of a folder: a scene without the animation that the tool takes
  failed
};

// "done", "unchanged", "left out", "failed".
const char* name_of(FileState state);

// Counts the files of a batch by status.
class BatchTally {
 public:
  explicit BatchTally(std::size_t files = 0) : files_(files) {}

  void add(FileState state, const std::string& name, bool warned);

  std::size_t failed() const { return count(FileState::failed); }
  // {"files", "done", "with_warnings", "unchanged", "left_out" if any, "failed", "left"}
  Json result() const;
  // "12 files{of_what}, 10 done, 2 failed; 3 with warnings"; zero counts are omitted.
  std::string summary(const std::string& of_what) const;
  // Error that names the first failed files. Without `kept_going`, the first ended the batch.
  Error failure(bool kept_going) const;

 private:
  std::size_t count(FileState state) const { return counts_[static_cast<std::size_t>(state)]; }
  std::size_t left() const;

  std::size_t files_;
  std::array<std::size_t, 4> counts_{};
  std::size_t warned_ = 0;           // files that are done
  std::vector<std::string> failed_;  // names, the first few
};

}  // namespace krok::cli::batch
