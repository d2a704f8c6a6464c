#include "tools/krok-diff/options.h"

#include <fmt/format.h>

#include <chrono>

#include "core/file.h"
#include "tools/krok-diff/compare_files.h"
#include "tools/krok-diff/folders.h"

namespace krok::cli::diff {

Result<int> run(const Options& given, ToolContext& context) {
  Options options = given;
  if (!options.joints.empty()) options.tolerance.joint_positions = options.joints[0];
  if (options.joints.size() > 1) options.tolerance.joint_orientations = options.joints[1];
  const auto folders = are_folders(options);
  if (!folders) return folders.error();
  if (*folders) return run_folders(options, context);
  const auto begin = std::chrono::steady_clock::now();
  const auto outcome = compare_files(options, context);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  FolderOutcome pair;
  FileResult& file = pair.files.emplace_back();
  file.path = base_name(options.second);
  file.seconds = taken.count();
  if (!outcome) {
    const Error& error = outcome.error();
    file.status = FileStatus::unreadable;
    file.what = fmt::format("{} [{}]", error.message, error.code);
    // A page of an earlier run, left as it is, would say that all is well.
    if (error.code != "usage") (void)write_summary(pair, {}, options, context);
    return error;
  }
  context.report.result = to_json(*outcome, options.tolerance);
  if (!context.quiet) context.print(to_text(*outcome, options.tolerance));
  if (!options.summaries.empty()) {
    file.status = outcome->same ? FileStatus::same : FileStatus::differs;
    file.what = worst_of(*outcome);
    file.detail = detail_of(*outcome, options.tolerance);
    if (Status status = write_summary(pair, {}, options, context); !status) return status.error();
  }
  return outcome->same ? kExitDone : kExitNo;
}

}  // namespace krok::cli::diff
