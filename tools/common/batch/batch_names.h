#pragma once

#include <map>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/result.h"
#include "tools/common/batch/batch_list.h"

namespace krok {

// The results of a file that the list tells: its output, and those that options name.
std::vector<std::string> outputs_of(const BatchFile& file, const BatchList& list,
                                    const std::string& out_dir);

// Which file of a batch a result belongs to whose name the list does not tell, "hero_{clip}.anim".
class BatchNames {
 public:
  // The list is to outlive this.
  BatchNames(const BatchList& list, std::string out_dir)
      : list_(list), out_dir_(std::move(out_dir)) {}

  // Whether `path` is no file that the batch reads, nor a result that the list tells (code usage).
  // Can be called from several threads.
  Status check(const std::string& path);

  // Gives the paths to the file `input`, all or none: an Error (code usage) where another has one
  // of them. To be called in the order of the list, so that the same files win whatever -j is.
  Status claim(const std::vector<std::string>& paths, const std::string& input);

 private:
  const BatchList& list_;
  std::string out_dir_;
  std::once_flag listed_once_;
  std::unordered_map<std::string, std::string> listed_;  // places that the list tells: inputs
  std::map<std::string, std::string> owners_;            // the same of those claimed
};

}  // namespace krok
