#include "tools/krok-diff/folders.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/glob.h"
#include "tools/cli/paths.h"

// Selects the files of a folder to compare.

namespace krok::cli::diff {

namespace {

namespace fs = std::filesystem;

std::vector<std::string_view> parts_of(std::string_view path) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0; at < path.size();) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    if (end > at) parts.push_back(path.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

class Walk {
 public:
  Walk(const std::string& folder, const PathFilter& filter, const std::string& other,
       const std::vector<std::string>& written)
      : folder_(folder), filter_(filter), other_(other) {
    for (const std::string& path : written) written_.insert(place_of(path));
    written_.erase("");
  }

  Result<FolderFiles> run() && {
    std::vector<std::string> folders = {""};
    while (!folders.empty()) {
      const std::string below = std::move(folders.back());
      const std::string before = below.empty() ? "" : below + "/";
      folders.pop_back();
      std::error_code trouble;
      const fs::path path = fs::path(folder_) / below;
      fs::directory_iterator entry(path, trouble);
      for (; !trouble && entry != fs::directory_iterator(); entry.increment(trouble)) {
        const std::string name = entry->path().filename().string();
        if (name.front() == '.' || matches("krok-*.journal.jsonl", name)) continue;
        take(*entry, before + name, folders);
      }
      if (trouble) {
        return Error("file-unreadable",
                     fmt::format("cannot read the folder: {}", trouble.message()))
            .in_file(path.string());
      }
    }
    std::sort(found_.paths.begin(), found_.paths.end());
    std::sort(found_.notes.begin(), found_.notes.end());
    return std::move(found_);
  }

 private:
  void take(const fs::directory_entry& entry, const std::string& below,
            std::vector<std::string>& folders) {
    std::error_code unknown;
    const fs::file_status status = entry.status(unknown);
    if (fs::is_directory(status)) {
      if (entry.is_symlink(unknown)) {
        leave_out(entry, "a link to a folder");
      } else if (!fs::equivalent(entry.path(), other_, unknown)) {
        folders.push_back(below);
      }
      return;
    }
    if (!filter_.takes(below)) return;
    // A dangling link is kept, so that it is reported as unreadable.
    if (fs::exists(status) && !fs::is_regular_file(status)) {
      leave_out(entry, "not a regular file");
    } else if (written_.empty() || written_.count(place_of(entry.path().string())) == 0) {
      found_.paths.push_back(below);
    }
  }

  void leave_out(const fs::directory_entry& entry, const char* what) {
    found_.notes.push_back(fmt::format("{} was skipped: {}", entry.path().string(), what));
  }

  const std::string& folder_;
  const PathFilter& filter_;
  const std::string& other_;
  std::set<std::string> written_;
  FolderFiles found_;
};

// Whether a path matches a pattern; ** as a path component matches any number of folders.
bool path_fits(std::string_view pattern, std::string_view path) {
  const auto wanted = parts_of(pattern), parts = parts_of(path);
  // After each pattern component: the possible numbers of path components consumed.
  std::vector<bool> used(parts.size() + 1, false);
  used[0] = true;
  for (const std::string_view part : wanted) {
    std::vector<bool> next(used.size(), false);
    for (std::size_t n = 0; n < used.size(); ++n) {
      if (part == "**") {
        next[n] = used[n] || (n > 0 && next[n - 1]);
      } else if (n > 0 && used[n - 1]) {
        next[n] = matches(part, parts[n - 1]);
      }
    }
    used = std::move(next);
  }
  return used.back();
}

}  // namespace

bool PathFilter::takes(const std::string& path) const {
  const auto fits = [&](const std::string& pattern) {
    return path_fits(pattern, pattern.find('/') == std::string::npos
                                  ? std::string_view(path).substr(path.rfind('/') + 1)
                                  : std::string_view(path));
  };
  return (include.empty() || std::any_of(include.begin(), include.end(), fits)) &&
         std::none_of(exclude.begin(), exclude.end(), fits);
}

Result<FolderFiles> files_in(const std::string& folder, const PathFilter& filter,
                             const std::string& other, const std::vector<std::string>& written) {
  return Walk(folder, filter, other, written).run();
}

}  // namespace krok::cli::diff
