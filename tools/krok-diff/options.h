#pragma once

#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/measure.h"
#include "tools/cli/tool.h"
#include "tools/krok-diff/difference_sheet.h"
#include "tools/krok-diff/folders.h"

namespace krok::cli::diff {

struct Options {
  std::string first, second;  // paths
  compare::Matching matching = compare::Matching::automatic;
  bool materials = false;  // whether different materials count as a difference
  compare::Tolerance tolerance;
  std::vector<double>
      joints;  // those of joints: metres and maybe radians; into `tolerance` by run()
  SheetOptions sheet;
  std::string plot;     // path; empty for none
  std::string heatmap;  // path; empty for none
  std::string summary;  // path of a page, .html or .md; empty for none
  FolderOptions folders;

  // Whether the summary shows pictures and charts.
  bool has_page() const;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Compares two files or two folders, prints and reports the differences.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::diff
