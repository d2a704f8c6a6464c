#include "tools/common/paths.h"

#include <sys/stat.h>

#include <filesystem>

namespace krok {

namespace fs = std::filesystem;

bool same_file(const std::string& first, const std::string& second) {
  if (first == "-" || second == "-") return false;
  std::error_code error;
  const auto status = fs::status(first, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return false;
  if (fs::equivalent(first, second, error)) return true;
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
  std::error_code error;
  const auto status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return {};
  const fs::path place = fs::weakly_canonical(absolute_path(path), error);
  return error ? absolute_path(path) : place.string();
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
