#include "tools/common/paths.h"

#include <sys/stat.h>

#include <filesystem>

namespace krok {

namespace fs = std::filesystem;

namespace {

// The folder without links; what of it does not exist stays as it is. Many files of a run stand in
// one folder, and finding this takes a question to the system for each part of its name.
fs::path real_folder(const fs::path& folder) {
  thread_local fs::path last, last_real;
  if (last != folder || last.empty()) {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(folder, error);
    last_real = error ? folder : real;
    last = folder;
  }
  return last_real;
}

}  // namespace

bool same_file(const std::string& first, const std::string& second) {
  if (first == "-" || second == "-") return false;
  struct stat one {
  }, other{};
  const bool first_exists = stat(first.c_str(), &one) == 0;
  if (first_exists && !S_ISREG(one.st_mode)) return false;
  const bool second_exists = stat(second.c_str(), &other) == 0;
  if (first_exists != second_exists) return false;
  if (first_exists) return one.st_dev == other.st_dev && one.st_ino == other.st_ino;
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(first, error);
  return !error && canonical == fs::weakly_canonical(second, error) && !error;
}

std::optional<FileNumber> file_number(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return FileNumber(status.st_dev, status.st_ino);
}

std::string place_of(const std::string& path) {
  if (path == "-") return {};
  struct stat status {};
  const bool exists = lstat(path.c_str(), &status) == 0;
  const fs::path absolute = absolute_path(path);
  if (exists && S_ISLNK(status.st_mode)) {
    if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) return {};
    std::error_code error;
    const fs::path place = fs::weakly_canonical(absolute, error);
    return error ? absolute.string() : place.string();
  }
  if (exists && !S_ISREG(status.st_mode)) return {};
  return (real_folder(absolute.parent_path()) / absolute.filename()).string();
}

Error replaced_error(const std::string& path) {
  return Error("usage", "is read and would be replaced by a result", "choose another name")
      .in_file(path);
}

Error twice_error(const std::string& path) {
  return Error("usage", path + " would be written twice", "give each result its own file");
}

std::string below(const std::string& folder, const std::string& path) {
  return (fs::path(folder) / path).string();
}

std::string absolute_path(const std::string& path) {
  std::error_code unknown;
  const fs::path absolute = fs::absolute(path, unknown);
  return (unknown ? fs::path(path) : absolute).lexically_normal().string();
}

}  // namespace krok
