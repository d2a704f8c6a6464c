#include "tools/batch/report.h"

#include <fmt/format.h>

#include "tools/cli/json_line.h"

namespace krok::cli::batch {

Status BatchReport::begin(const std::string& path, OutputFile::Options how, const std::string& tool,
                          const std::string& version, const Json& options) {
  if (path.empty()) return {};
  auto file = OutputFile::create(path, how);
  if (!file) return file.error();
  file_ = std::move(*file);
  return file_->write(
      fmt::format("{{\n  \"schema\": \"krok.batch/1\",\n  \"tool\": {},\n  \"version\": {},\n"
                  "  \"options\": {},\n  \"files\": [",
                  json_line(tool), json_line(version), json_line(options)));
}

// The file keeps write errors; end() returns them.
void BatchReport::add(const Json& file) {
  if (!file_) return;
  (void)file_->write((first_ ? "\n    " : ",\n    ") + json_line(rounded(file))).ok();
  first_ = false;
}

Status BatchReport::end(const Diagnostics& issues, const Json& result) {
  if (!file_) return {};
  const Status status = file_->write(fmt::format("{}],\n  \"issues\": {},\n  \"result\": {}\n}}\n",
                                                 first_ ? "" : "\n  ", json_line(to_json(issues)),
                                                 json_line(rounded(result))));
  const Status done = file_->commit();
  file_.reset();
  return status ? done : status;
}

}  // namespace krok::cli::batch
