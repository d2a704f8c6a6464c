#pragma once

#include <optional>
#include <string>

#include "core/file.h"
#include "tools/common/report.h"

namespace krok {

// The report of a batch as JSON (schema krok.batch/1), written while files are done, for there may
// be any number of them:
//
//   {"schema", "tool", "version", "options",
//    "files": [{"input", "output", "status", "options", "inputs", "outputs", "issues", "result"}],
//    "issues": [], "result": {"files", "done", "unchanged", "failed", "left"}}
//
// A file a line, in the order of the list, whatever the number of threads; its status is done,
// unchanged or failed. "issues" are those of the batch as a whole, in the form of krok.report/1.
class BatchReport {
 public:
  // An empty path is for no report.
  Status begin(const std::string& path, OutputFile::Options how, const std::string& tool,
               const std::string& version, const Json& options);
  bool is_wanted() const { return file_.has_value(); }
  void add(const Json& file);
  Status end(const Diagnostics& issues, const Json& result);

 private:
  std::optional<OutputFile> file_;
  bool first_ = true;
};

}  // namespace krok
