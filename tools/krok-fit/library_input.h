#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/library/library_description.h"
#include "parametric/cut_steps.h"
#include "parametric/library.h"
#include "tools/common/tool.h"
#include "tools/krok-fit/example_motions.h"

// From the description of a library and the motions that it names to the library.

namespace krok::fit_tool {

struct LibraryInput {
  library::LibraryDescription description;
  RoleMap roles;
  parametric::Library library;
  std::vector<double> lower, upper;  // [parameters], the range that is asked for
  std::vector<parametric::DroppedStep> dropped;
  int found = 0;  // examples before those too close to others were left out
  // All of these, where the library has steps that were found and the description tells no spacing.
  std::vector<parametric::Example> all_steps;
  int mirrored = 0;  // examples that are mirrored steps
  std::vector<RefusedClip> refused;
};

// Reads the description at `path` and the motions below its folder. A motion that does not fit, for
// its skeleton is another one than most have, is an Error, or with `keep_going` is told and left
// out. Codes: those of library::read and of reading motions; library-clip for a pattern that fits
// no file; library-keytimes, library-examples; those of parametric::cut_steps and make_example.
Result<LibraryInput> read_library(const std::string& path, bool keep_going, ToolContext& context);

// Makes examples of all steps, for weights that are smoothed; of such as measure the same one
// stays.
void take_all_steps(LibraryInput& input);

}  // namespace krok::fit_tool
