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
  bool materials = false;  // whether other materials are a difference
  compare::Tolerance tolerance;
  SheetOptions sheet;
  std::string plot;     // a path; empty for none
  std::string heatmap;  // the same
  FolderOptions folders;
};

// Reads both files, compares them and draws what is wanted of the difference. Codes diff-kind (a
// file of a kind that cannot be compared), diff-kinds (two kinds), and those of the readers.
Result<Outcome> compare_files(const Options& options, ToolContext& context);

}  // namespace krok::diff
