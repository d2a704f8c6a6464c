#pragma once

#include <optional>
#include <string>

#include "core/file.h"
#include "tools/cli/report.h"

namespace krok::cli::batch {

// The report of a batch as JSON (schema krok.batch/1), streamed while files are processed to bound
// memory:
//
//   {"schema", "tool", "version", "options",
//    "files": [{"input", "output", "status", "options", "inputs", "outputs", "issues", "result"}],
//    "issues": [], "result": {"files", "done", "unchanged", "failed", "left"}}
//
// One file per line, in list order for any number of threads; the status is done, unchanged or
// failed. The last "issues" are those of the batch as a whole, as in krok.report/1.
class BatchReport {
 public:
  // No report if `path` is empty.
  Status begin(const std::string& path, OutputFile::Options how, const std::string& tool,
               const std::string& version, const Json& options);
  bool is_wanted() const { return file_.has_value(); }
  void add(const Json& file);
  Status end(const Diagnostics& issues, const Json& result);

 private:
  std::optional<OutputFile> file_;
  bool first_ = true;
};

}  // namespace krok::cli::batch
