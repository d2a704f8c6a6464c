#pragma once

#include <cstddef>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "tools/cli/tool.h"

namespace krok::cli {

// The output files of one run, written atomically: all appear or none. Each path is checked by
// ToolContext::check_output before writing starts. Write errors without a file name get the path.
class OutputSet {
 public:
  explicit OutputSet(ToolContext& context) : context_(context) {}

  // Writes a file under a temporary name beside `path`. Does nothing if `path` is empty.
  Status add(const std::string& path, const std::function<Status(OutputFile&)>& write);

  // The same for text and bytes.
  Status add(const std::string& path, std::string_view text);
  Status add(const std::string& path, std::span<const std::byte> bytes);

  // The same for several files, on up to `jobs` threads. If several fail, the error of the first
  // file in the list is returned. write(i, file) writes the ith file.
  Status add_all(const std::vector<std::string>& paths, int jobs,
                 const std::function<Status(std::size_t, OutputFile&)>& write);

  // The same, but without the files for which write() returns false.
  Status add_some(const std::vector<std::string>& paths, int jobs,
                  const std::function<Result<bool>(std::size_t, OutputFile&)>& write);

  // Renames all files to their final names once each is safely on disk, and adds them to the
  // report. With a report, that is when the run ends: the report is one of the set. In a batch,
  // files whose names are not known from the command line are handed over to the batch, which
  // renames them in list order.
  Status finish();

  // The paths so far, for messages.
  std::string names() const;

 private:
  ToolContext& context_;
  std::vector<std::string> paths_;
  std::set<std::string> places_;
  std::vector<OutputFile> files_;
};

// Writes a single output file; `content` is what OutputSet::add() takes.
template <typename Content>
Status write_output(ToolContext& context, const std::string& path, const Content& content) {
  OutputSet outputs(context);
  if (Status status = outputs.add(path, content); !status) return status;
  return outputs.finish();
}

// Folders for outputs; removed again unless keep() is called.
class NewFolders {
 public:
  NewFolders() = default;
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders();

  // Creates a folder and its missing parents. Code file-unwritable.
  Status make(const std::string& folder);

  // Keeps the folders: the outputs are in them.
  void keep() { made_.clear(); }

 private:
  std::vector<std::string> made_;  // parents first
};

}  // namespace krok::cli
