#include "tools/common/paths.h"

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

std::string below(const std::string& folder, const std::string& path) {
  return (fs::path(folder) / path).string();
}

std::string absolute_path(const std::string& path) {
  std::error_code unknown;
  const fs::path absolute = fs::absolute(path, unknown);
  return (unknown ? fs::path(path) : absolute).lexically_normal().string();
}

}  // namespace krok
