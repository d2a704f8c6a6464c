#include "tools/cli/paths.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

namespace krok::cli {

namespace fs = std::filesystem;

namespace {

// Resolves links in a folder's path; missing components are kept. Cached, as many files share a
// folder and resolving takes a system call per path component.
const std::string& real_folder(const std::string& folder) {
  thread_local std::string last, last_real;
  if (last != folder || last.empty()) {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(folder, error);
    last_real = error ? folder : real.string();
    last = folder;
  }
  return last_real;
}

// Whether a path has no ".", ".." or double slash; a leading slash is allowed.
bool is_normal(std::string_view path) {
  for (std::size_t at = path.starts_with('/') ? 1 : 0;;) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    const std::string_view part = path.substr(at, end - at);
    if (part.empty() || part == "." || part == "..") return false;
    if (end == path.size()) return true;
    at = end + 1;
  }
}

// "/", "b" -> "/b"; "/a", "b" -> "/a/b".
std::string joined(const std::string& folder, std::string_view name) {
  std::string path;
  path.reserve(folder.size() + 1 + name.size());
  path += folder;
  if (!folder.ends_with('/')) path += '/';
  path += name;
  return path;
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
  const std::string absolute = absolute_path(path);
  if (exists && S_ISLNK(status.st_mode)) {
    if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) return {};
    std::error_code error;
    const fs::path place = fs::weakly_canonical(absolute, error);
    return error ? absolute : place.string();
  }
  if (exists && !S_ISREG(status.st_mode)) return {};
  const std::size_t slash = absolute.rfind('/');
  if (slash == std::string::npos) return absolute;  // the current folder is gone
  const std::string_view name = std::string_view(absolute).substr(slash + 1);
  return joined(real_folder(absolute.substr(0, std::max<std::size_t>(slash, 1))), name);
}

Error replaced_error(const std::string& path) {
  return Error("usage", "is an input and would be overwritten by an output", "choose another name")
      .in_file(path);
}

Error twice_error(const std::string& path) {
  return Error("usage", path + " would be written twice", "give each output its own file");
}

std::string below(const std::string& folder, const std::string& path) {
  return (fs::path(folder) / path).string();
}

std::string absolute_path(const std::string& path) {
  std::error_code unknown;
  if (is_normal(path)) {  // fast path: most are
    if (path.starts_with('/')) return path;
    const std::string folder = fs::current_path(unknown).string();
    if (!unknown) return joined(folder, path);
    return path;
  }
  const fs::path absolute = fs::absolute(path, unknown);
  return (unknown ? fs::path(path) : absolute).lexically_normal().string();
}

}  // namespace krok::cli
