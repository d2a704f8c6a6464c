#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "tools/cli/report.h"
#include "tools/cli/tool.h"
#include "tools/krok-diff/outcome.h"

// Compares two folders: files are paired by their relative paths.

namespace krok::cli::diff {

struct Options;

// Shell patterns. Without a slash they match file names, "*.glb"; with a slash, paths relative to
// the folder, "walks/**/*.glb". An empty `include` matches all files.
struct PathFilter {
  std::vector<std::string> include, exclude;

  bool takes(const std::string& path) const;
};

struct FolderOptions {
  PathFilter filter;
  bool keep_going = false;  // after a file that cannot be read
  bool update = false;      // make the first folder equal to the second
  bool prune = false;       // also remove files that only the first has

  bool any() const {
    return !filter.include.empty() || !filter.exclude.empty() || keep_going || update || prune;
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

// What the page of a summary shows of a pair of files that differ.
struct FileDetail {
  double excess = 0;  // largest ratio of a difference to its tolerance; see excess_of()
  std::string text;   // all measures
  std::optional<Pictures> pictures;
  std::string chart;  // SVG; empty for none
};
FileDetail detail_of(Outcome outcome, const compare::Tolerance& tolerance);

// The result for the files of one path.
struct FileResult {
  std::string path;  // relative to both folders; for two files, the second's name
  FileStatus status = FileStatus::not_compared;
  std::string what;    // the largest difference, or why the file cannot be read; a message
  Json outcome;        // metrics of files that differ, if a report is requested
  FileDetail detail;   // of files that differ, if a summary is requested
  double seconds = 0;  // that the comparison took
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

// Copies changed and new files to the first folder: all of them or, on failure, none. Call only if
// all files could be read.
Result<FolderUpdate> update_first(const Options& options, const FolderOutcome& outcome,
                                  ToolContext& context);

// Text report: a line for each file that is not the same (with `all`, for every file), and a table.
std::string to_text(const FolderOutcome& outcome, const Options& options, bool all);
Json to_json(const FolderOutcome& outcome, const Options& options);

// "golden against out", printable.
std::string title_of(const Options& options);
// Labels of statuses and counts; counts of 0 are omitted except for `same`.
std::vector<std::pair<std::string, std::size_t>> counts_of(const FolderOutcome& outcome,
                                                           const Options& options);

// "the same", "differs", "only in golden".
std::string status_words(FileStatus status, const Options& options);

struct FolderFiles {
  std::vector<std::string> paths;  // relative to the folder, sorted bytewise
  std::vector<std::string> notes;  // messages about skipped files
};

// The files in a folder and its sub-folders. Skipped silently: names that begin with a dot, batch
// journals (krok-import.journal.jsonl), files that the filter excludes, and the folder `other` and
// the files `written` if they are inside. Skipped with a note: links to folders (which could form
// loops), devices and pipes (which could block). Error (code file-unreadable) for a folder that
// cannot be read.
Result<FolderFiles> files_in(const std::string& folder, const PathFilter& filter,
                             const std::string& other, const std::vector<std::string>& written);

// Writes a page of the files that are not the same, the worst first: HTML with pictures and charts
// inside, which needs no other file, or, by extension, Markdown, or a test case for each file
// (JUnit) for CI servers. Links to the files compared are relative to the page.
Status write_summary(const FolderOutcome& outcome, const FolderUpdate& update,
                     const Options& options, ToolContext& context);

}  // namespace krok::cli::diff
