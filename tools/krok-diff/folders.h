#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"
#include "tools/krok-diff/folder_files.h"

// Compares two folders: files are paired by their relative paths.

namespace krok::cli::diff {

struct Options;

struct FolderOptions {
  PathFilter filter;
  bool keep_going = false;  // after a file that cannot be read
  bool update = false;      // make the first folder equal to the second
  bool prune = false;       // also remove files that only the first has
  std::string summary;      // path of a report page, .html or .md; empty for none

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
  not_compared,  // because an earlier file could not be read
};

// The result for the files of one path.
struct FileResult {
  std::string path;  // relative to both folders
  FileStatus status = FileStatus::not_compared;
  std::string what;  // the largest difference, or why the file cannot be read; a message
  Json outcome;      // metrics of files that differ, if a report is requested
};

struct FolderOutcome {
  std::vector<FileResult> files;   // sorted by path
  std::vector<std::string> notes;  // messages about skipped files

  std::size_t count(FileStatus status) const;
};

// What --update did: paths relative to the folders.
struct FolderUpdate {
  std::vector<std::string> replaced, added, removed;
};

// Declares the folder options.
void declare_folder_options(CommandOptions& command, FolderOptions& options);

// Whether both inputs are folders. Error (code diff-kinds) for a folder and a file, (code usage)
// for two files with folder options.
Result<bool> are_folders(const Options& options);

// Compares the folders Options::first and second, prints the result, updates the first if
// requested, and fills in the report. Returns an exit code. Code diff-empty: there are no files to
// compare.
Result<int> run_folders(const Options& options, ToolContext& context);

// Compares all files, or those up to the first that cannot be read.
Result<FolderOutcome> compare_folders(const Options& options, ToolContext& context);

// Copies changed and new files to the first folder: all of them or, on failure, none. Call only if
// all files could be read.
Result<FolderUpdate> update_first(const Options& options, const FolderOutcome& outcome,
                                  ToolContext& context);

// Text report: a line for each file that is not the same (with `all`, for every file), and a table.
std::string to_text(const FolderOutcome& outcome, const Options& options, bool all);
Json to_json(const FolderOutcome& outcome, const Options& options);

// Error usage if the extension of --summary is not supported.
Status check_summary_name(const std::string& path);
// Writes a page with a row for each file that is not the same, as HTML or, by extension, Markdown.
Status write_summary(const FolderOutcome& outcome, const FolderUpdate& update,
                     const Options& options, ToolContext& context);

// "the same", "differs", "only in golden".
std::string status_words(FileStatus status, const Options& options);

}  // namespace krok::cli::diff
