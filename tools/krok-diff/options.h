#pragma once

#include <string>
#include <vector>

#include "compare/matching.h"
#include "compare/measure.h"
#include "tools/cli/tool.h"
#include "tools/krok-diff/difference_sheet.h"
#include "tools/krok-diff/folders.h"

namespace krok::cli::diff {

// Whether a summary of that name is HTML.
bool is_page(const std::string& summary);

struct Options {
  std::string first, second;  // paths
  compare::Matching matching = compare::Matching::automatic;
  bool materials = false;  // whether different materials count as a difference
  compare::Tolerance tolerance;
  std::vector<double>
      joints;  // those of joints: metres and maybe radians; into `tolerance` by run()
  SheetOptions sheet;
  std::string plot;                    // path; empty for none
  std::string heatmap;                 // path; empty for none
  std::vector<std::string> summaries;  // paths of pages: .html, .xml, else Markdown
  FolderOptions folders;

  // Whether a summary shows pictures and charts.
  bool has_page() const;
};

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Compares two files or two folders, prints and reports the differences.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::diff
