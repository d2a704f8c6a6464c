#pragma once

#include <string>
#include <vector>

#include "core/result.h"

namespace krok::cli {

// Folders for outputs; removed again unless keep() is called.
class NewFolders {
 public:
  NewFolders() = default;
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders();

  // Creates a folder and its missing parents. Code file-unwritable.
  Status make(const std::string& folder);

  // Keeps the folders: the outputs are in them.
  void keep() { made_.clear(); }

 private:
  std::vector<std::string> made_;  // parents first
};

}  // namespace krok::cli
