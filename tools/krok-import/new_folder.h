#pragma once

#include <string>

#include "core/result.h"

namespace krok::import {

// A folder for results, which is gone again if they do not come about.
class NewFolder {
 public:
  NewFolder() = default;
  NewFolder(const NewFolder&) = delete;
  ~NewFolder();

  // Makes it unless it is there already. Code file-unwritable.
  Status make(const std::string& path);

  // The results are in it.
  void keep() { path_.clear(); }

 private:
  std::string path_;  // of what was made
};

}  // namespace krok::import
