// Updates the first folder to match the second.

#include <fmt/format.h>

#include <filesystem>
#include <set>

#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/krok-diff/compare_files.h"
#include "tools/krok-diff/folders.h"

namespace krok::cli::diff {

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

}  // namespace krok::cli::diff
