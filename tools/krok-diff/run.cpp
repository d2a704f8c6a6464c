#include "tools/krok-diff/run.h"

#include "tools/krok-diff/compare_files.h"

namespace krok::cli::diff {

Result<int> run(const Options& options, ToolContext& context) {
  const auto folders = are_folders(options);
  if (!folders) return folders.error();
  if (*folders) return run_folders(options, context);
  const auto outcome = compare_files(options, context);
  if (!outcome) return outcome.error();
  context.report.result = to_json(*outcome, options.tolerance);
  if (!context.quiet) context.print(to_text(*outcome, options.tolerance));
  return outcome->same ? kExitDone : kExitNo;
}

}  // namespace krok::cli::diff
