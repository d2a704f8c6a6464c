#pragma once

#include <string>

#include "compare/matching.h"
#include "compare/measure.h"
#include "core/result.h"
#include "difference_sheet.h"
#include "folders.h"
#include "outcome.h"
#include "tools/common/tool.h"

namespace krok::diff {

struct Options {
  std::string first, second;  // paths
  compare::Matching matching = compare::Matching::automatic;
  bool materials = false;  // whether different materials count as a difference
  compare::Tolerance tolerance;
  SheetOptions sheet;
  std::string plot;     // path; empty for none
  std::string heatmap;  // path; empty for none
  FolderOptions folders;
};

// Compares both files and writes the requested plots and images. Codes diff-kind (a file type that
// cannot be compared), diff-kinds (two different types), and those of the readers.
Result<Outcome> compare_files(const Options& options, ToolContext& context);

}  // namespace krok::diff
