#include "core/glob.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace krok {

namespace {

namespace fs = std::filesystem;

// End of the set that starts with '[' at `begin`; npos if unclosed, and then '[' is literal.
std::size_t end_of_set(std::string_view pattern, std::size_t begin) {
  std::size_t first = begin + 1;
  if (first < pattern.size() && (pattern[first] == '!' || pattern[first] == '^')) ++first;
  return pattern.find(']', first + 1);  // a leading ']' is a member
}

bool in_set(std::string_view set, char c) {
  const bool negated = !set.empty() && (set[0] == '!' || set[0] == '^');
  if (negated) set.remove_prefix(1);
  const auto code = static_cast<unsigned char>(c);
  bool found = false;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto low = static_cast<unsigned char>(set[i]);
    auto high = low;
    if (i + 2 < set.size() && set[i + 1] == '-') {
      high = static_cast<unsigned char>(set[i + 2]);
      i += 2;
    }
    found = found || (low <= code && code <= high);
  }
  return found != negated;
}

std::vector<std::string> parts_of(const std::string& pattern) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= pattern.size();) {
    const std::size_t end = std::min(pattern.find('/', at), pattern.size());
    if (end > at) parts.push_back(pattern.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

// "a", "b" -> "a/b"; "", "b" -> "b".
std::string join(const std::string& folder, const std::string& name) {
  if (folder.empty() || folder.back() == '/') return folder + name;
  return folder + "/" + name;
}

class Search {
 public:
  explicit Search(std::vector<std::string> parts) : parts_(std::move(parts)) {}

  Status in(const std::string& folder, std::size_t part) {
    if (part == parts_.size()) return {};
    const std::string& pattern = parts_[part];
    const bool last = part + 1 == parts_.size();
    if (!has_wildcards(pattern)) {
      const std::string path = join(folder, pattern);
      std::error_code missing;
      if (last && fs::exists(path, missing) && !fs::is_directory(path, missing)) add(path);
      return !last && fs::is_directory(path, missing) ? in(path, part + 1) : Status();
    }
    const bool any_folders = pattern == "**";
    if (any_folders && !last) {
      if (Status status = in(folder, part + 1); !status) return status;
    }
    std::error_code trouble;
    fs::directory_iterator entry(folder.empty() ? "." : folder, trouble);
    for (; !trouble && entry != fs::directory_iterator(); entry.increment(trouble)) {
      const std::string name = entry->path().filename().string();
      if (!matches(any_folders ? "*" : pattern, name)) continue;
      const std::string path = join(folder, name);
      std::error_code unknown;
      if (!entry->is_directory(unknown)) {
        if (last) add(path);
      } else if (any_folders ? !entry->is_symlink(unknown) : !last) {
        if (Status status = in(path, any_folders ? part : part + 1); !status) return status;
      }
    }
    if (trouble) {
      return Error("file-unreadable", fmt::format("cannot search folder: {}", trouble.message()))
          .in_file(folder.empty() ? "." : folder);
    }
    return {};
  }

  std::vector<std::string> found() && {
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    return std::move(found_);
  }

 private:
  void add(const std::string& path) { found_.push_back(path); }

  std::vector<std::string> parts_;
  std::vector<std::string> found_;
};

}  // namespace

bool has_wildcards(std::string_view text) {
  return text.find_first_of("*?[") != std::string_view::npos;
}

bool matches(std::string_view pattern, std::string_view name) {
  if (!name.empty() && name[0] == '.' && (pattern.empty() || pattern[0] != '.')) return false;
  // After a '*', the rest is tried at each position. Only the last '*' needs backtracking.
  std::size_t p = 0, n = 0, star = std::string_view::npos, star_name = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_name = n;
      continue;
    }
    std::size_t next = p;
    bool fits = false;
    if (p < pattern.size()) {
      const std::size_t end = pattern[p] == '[' ? end_of_set(pattern, p) : std::string_view::npos;
      if (end != std::string_view::npos) {
        fits = in_set(pattern.substr(p + 1, end - p - 1), name[n]);
        next = end + 1;
      } else {
        fits = pattern[p] == '?' || pattern[p] == name[n];
        next = p + 1;
      }
    }
    if (fits) {
      p = next;
      ++n;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++star_name;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

std::string fixed_part(const std::string& pattern) {
  const std::size_t wildcard = pattern.find_first_of("*?[");
  if (wildcard == std::string::npos) return fs::path(pattern).parent_path().string();
  const std::size_t slash = pattern.rfind('/', wildcard);
  if (slash == std::string::npos) return {};
  return slash == 0 ? "/" : pattern.substr(0, slash);
}

Result<std::vector<std::string>> find_files(const std::string& pattern) {
  const std::string fixed = fixed_part(pattern);
  Search search(parts_of(pattern.substr(std::min(fixed.size(), pattern.size()))));
  std::error_code missing;
  if (!fixed.empty() && !fs::is_directory(fixed, missing)) return std::vector<std::string>();
  if (Status status = search.in(fixed, 0); !status) return status.error();
  return std::move(search).found();
}

Result<std::vector<std::string>> find_files_below(const std::string& folder) {
  Search search({"**"});
  if (Status status = search.in(folder, 0); !status) return status.error();
  return std::move(search).found();
}

}  // namespace krok
