#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/cli/report.h"

namespace krok::cli::batch {

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
