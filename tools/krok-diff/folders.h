#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/result.h"
#include "folder_files.h"
#include "tools/common/report.h"
#include "tools/common/tool.h"

// A folder against a folder: files are paired by their paths.

namespace krok::diff {

struct Options;

struct FolderOptions {
  PathFilter filter;
  bool keep_going = false;  // after a file that cannot be read
  bool update = false;      // make the first folder what the second is
  bool prune = false;       // and remove from it what the second does not have
  std::string summary;      // a path of a page, .html or .md; empty for none

  bool any() const {
    return !filter.include.empty() || !filter.exclude.empty() || keep_going || update || prune ||
           !summary.empty();
  }
};

enum class FileStatus : unsigned char {
  same,
  differs,
  only_in_first,
  only_in_second,
  unreadable,
  not_compared,  // for one before could not be read
};

// What became of the files of one path.
struct FileResult {
  std::string path;  // below both folders
  FileStatus status = FileStatus::not_compared;
  std::string what;  // what differs most, or why it cannot be read; for people
  Json outcome;      // the measures of those that differ, where a report is wanted
};

struct FolderOutcome {
  std::vector<FileResult> files;   // sorted by path
  std::vector<std::string> notes;  // what was left out, for people

  std::size_t count(FileStatus status) const;
};

// What --update did: paths below the folders.
struct FolderUpdate {
  std::vector<std::string> replaced, added, removed;
};

// The options that are about folders.
void declare_folder_options(CommandOptions& command, FolderOptions& options);

// Whether these options compare folders: an Error (code diff-kinds) for a folder and a file, (code
// usage) for two files with options that are about folders.
Result<bool> are_folders(const Options& options);

// Compares the folders Options::first and second, prints what was found, updates the first where
// that is wanted, and fills in the report. The value is an exit code. Code diff-empty: there is
// nothing to compare.
Result<int> run_folders(const Options& options, ToolContext& context);

// Compares all files, or those up to the first that cannot be read.
Result<FolderOutcome> compare_folders(const Options& options, ToolContext& context);

// Copies what differs, or is new, over the first folder: all of it or, where something fails,
// nothing. To be called when all files could be read.
Result<FolderUpdate> update_first(const Options& options, const FolderOutcome& outcome,
                                  ToolContext& context);

// For people: a line for each file that is not the same (with `all` for each), and a table.
std::string to_text(const FolderOutcome& outcome, const Options& options, bool all);
Json to_json(const FolderOutcome& outcome, const Options& options);

// Whether --summary may have this name: Error usage.
Status check_summary_name(const std::string& path);
// A page with a row for each file that is not the same, as HTML or, by its name, Markdown.
Status write_summary(const FolderOutcome& outcome, const FolderUpdate& update,
                     const Options& options, ToolContext& context);

// "the same", "differs", "only in golden".
std::string status_words(FileStatus status, const Options& options);

}  // namespace krok::diff
