#pragma once

#include <string>
#include <vector>

#include "core/result.h"

namespace krok {

// Folders for results, which are gone again if the results do not come about.
class NewFolders {
 public:
  NewFolders() = default;
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders();

  // Makes a folder, and those that it lies in, where they are missing. Code file-unwritable.
  Status make(const std::string& folder);

  // The results are in them.
  void keep() { made_.clear(); }

 private:
  std::vector<std::string> made_;  // outer ones first
};

}  // namespace krok
