#include "tools/krok-diff/folders.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include "core/glob.h"
#include "core/numbers.h"
#include "core/text.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/krok-diff/compare_files.h"

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

// Updates the first folder to match the second.

namespace {

namespace fs = std::filesystem;

// Creates `folder` below `root`. Links are rejected: their targets are not compared either.
Status make_folder(const fs::path& folder, const fs::path& root, NewFolders& folders) {
  std::error_code unknown;
  if (folder != root) {
    if (Status status = make_folder(folder.parent_path(), root, folders); !status) return status;
    if (fs::is_symlink(fs::symlink_status(folder, unknown))) {
      return Error("file-unwritable", "is a link, and links are not followed",
                   "replace it by a folder")
          .in_file(folder.string());
    }
  }
  return folders.make(folder.string());
}

Result<OutputFile> copy_of(const std::string& source, const std::string& target) {
  const auto from = InputFile::open(source);
  if (!from) return from.error();
  auto to = OutputFile::create(target);
  if (!to) return to.error();
  if (Status status = to->write(from->bytes()); !status) return status.error();
  if (Status status = to->seal(); !status) return status.error();
  return to;
}

}  // namespace

Result<FolderUpdate> update_first(const Options& options, const FolderOutcome& outcome,
                                  ToolContext& context) {
  const bool prune = options.folders.prune;
  if (prune && outcome.count(FileStatus::only_in_first) == outcome.files.size()) {
    return Error("diff-empty",
                 fmt::format("{} has no files, so --prune would remove all of {}", options.second,
                             options.first),
                 "check that the files were written");
  }
  FolderUpdate update;
  NewFolders folders;
  std::vector<OutputFile> copies;
  std::set<std::string> places;
  // Without a trailing slash, so that it is the parent of its entries.
  const fs::path root = fs::path(options.first).has_filename()
                            ? fs::path(options.first)
                            : fs::path(options.first).parent_path();
  for (const FileResult& file : outcome.files) {
    if (prune && file.status == FileStatus::only_in_first) update.removed.push_back(file.path);
    const bool differs = file.status == FileStatus::differs;
    if (!differs && file.status != FileStatus::only_in_second) continue;
    (differs ? update.replaced : update.added).push_back(file.path);
    const fs::path target = root / file.path;
    if (Status status = make_folder(target.parent_path(), root, folders); !status) {
      return status.error();
    }
    // Two links to the same file.
    if (!places.insert(place_of(target.string())).second) return twice_error(target.string());
    auto copy = copy_of(below(options.second, file.path), target.string());
    if (!copy) return std::move(copy.error()).in_file(target.string());
    copies.push_back(std::move(*copy));
  }
  if (Status status = OutputFile::place_all(copies); !status) return status.error();
  folders.keep();
  for (const auto* paths : {&update.replaced, &update.added}) {
    for (const std::string& path : *paths) context.wrote(below(options.first, path));
  }
  for (const std::string& path : update.removed) {
    std::error_code trouble;
    if (!fs::remove(root / path, trouble) && trouble) {
      return Error("file-unwritable", fmt::format("cannot remove the file: {}", trouble.message()))
          .in_file((root / path).string());
    }
  }
  return update;
}

// Reports on two folders: text and JSON.

namespace {

constexpr std::array kStatuses = {FileStatus::same,          FileStatus::differs,
                                  FileStatus::only_in_first, FileStatus::only_in_second,
                                  FileStatus::unreadable,    FileStatus::not_compared};
// [FileStatus]
constexpr std::array kKeys = {"same",           "differs",    "only_in_first",
                              "only_in_second", "unreadable", "not_compared"};

const char* status_key(FileStatus status) {
  return kKeys[static_cast<std::size_t>(status)];
}

std::string safe(const std::string& text) {
  return printable(to_utf8(text));
}

}  // namespace

std::string title_of(const Options& options) {
  return fmt::format("{} against {}", safe(options.first), safe(options.second));
}

std::vector<std::pair<std::string, std::size_t>> counts_of(const FolderOutcome& outcome,
                                                           const Options& options) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (const FileStatus status : kStatuses) {
    const std::size_t count = outcome.count(status);
    if (count > 0 || status == FileStatus::same) {
      counts.emplace_back(status_words(status, options), count);
    }
  }
  return counts;
}

std::string status_words(FileStatus status, const Options& options) {
  if (status == FileStatus::only_in_first) return "only in " + safe(options.first);
  if (status == FileStatus::only_in_second) return "only in " + safe(options.second);
  constexpr std::array kWords = {"the same", "differs", "", "", "cannot be read", "not compared"};
  return kWords[static_cast<std::size_t>(status)];
}

std::string to_text(const FolderOutcome& outcome, const Options& options, bool all) {
  std::string text;
  for (const FileResult& file : outcome.files) {
    const bool listed = file.status != FileStatus::same && file.status != FileStatus::not_compared;
    if (!listed && !all) continue;
    text += fmt::format("{}: {}{}{}\n", status_words(file.status, options), safe(file.path),
                        file.what.empty() ? "" : ": ", safe(file.what));
  }
  for (const std::string& note : outcome.notes) text += "note: " + safe(note) + "\n";
  const auto counts = counts_of(outcome, options);
  std::size_t width = 0;
  for (const auto& [words, count] : counts) width = std::max(width, words.size());
  text += fmt::format("{}: {}\n", title_of(options), counted(outcome.files.size(), "file"));
  for (const auto& [words, count] : counts) {
    text += fmt::format("  {:<{}}  {:>5}\n", words, width, count);
  }
  return text;
}

Json to_json(const FolderOutcome& outcome, const Options& options) {
  Json json;
  json["kind"] = "folders";
  json["same"] = outcome.count(FileStatus::same) == outcome.files.size();
  json["first"] = options.first;
  json["second"] = options.second;
  json["tolerance"] = to_json(options.tolerance);
  Json& counts = json["counts"];
  for (const FileStatus status : kStatuses) counts[status_key(status)] = outcome.count(status);
  json["notes"] = outcome.notes;
  json["files"] = Json::array();
  for (const FileResult& file : outcome.files) {
    Json entry;
    entry["path"] = file.path;
    entry["status"] = status_key(file.status);
    if (!file.what.empty()) entry["what"] = file.what;
    if (!file.outcome.is_null()) entry["difference"] = file.outcome;
    json["files"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace krok::cli::diff
