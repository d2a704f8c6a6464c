#include "tools/krok-import/new_folder.h"

#include <filesystem>

namespace krok::import {

namespace fs = std::filesystem;

NewFolder::~NewFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove(path_, ignored);  // where it is empty
}

Status NewFolder::make(const std::string& path) {
  std::error_code error;
  if (fs::create_directory(path, error)) path_ = path;
  if (!error && fs::is_directory(path, error)) return {};
  return Error("file-unwritable",
               "cannot be made a folder: " + (error ? error.message() : "a file has its name"))
      .in_file(path);
}

}  // namespace krok::import
