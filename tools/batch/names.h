#pragma once

#include <map>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/result.h"
#include "tools/batch/list.h"

namespace krok::cli::batch {

// The outputs of a file that are known from the list: its output, and those that options name.
std::vector<std::string> outputs_of(const BatchFile& file, const BatchList& list,
                                    const std::string& out_dir);

// Assigns outputs whose names are not known from the list ("hero_{clip}.anim") to files of a batch.
class BatchNames {
 public:
  // The list must outlive this.
  BatchNames(const BatchList& list, std::string out_dir)
      : list_(list), out_dir_(std::move(out_dir)) {}

  // Fails (code usage) if `path` is an input of the batch or an output known from the list.
  // Thread-safe.
  Status check(const std::string& path);

  // Assigns the paths to the file `input`, all or none: fails (code usage) if another file has one
  // of them. Call in list order, so that the winner does not depend on -j.
  Status claim(const std::vector<std::string>& paths, const std::string& input);

 private:
  const BatchList& list_;
  std::string out_dir_;
  std::once_flag listed_once_;
  std::unordered_map<std::string, std::string> listed_;  // known canonical path -> input
  std::map<std::string, std::string> owners_;            // claimed path -> input
};

}  // namespace krok::cli::batch
