#pragma once

#include "tools/common/command_line.h"
#include "tools/common/tool.h"

// Batch mode: a tool processes many files. Each file is parsed and run independently, as on its own
// command line, on one of -j threads; messages are printed in list order. Outputs go into
// --out-dir, in the same sub-folders as their inputs, or where a --manifest says. An output that is
// up to date, made from the same input with the same options by the same version, is skipped
// (journal.h). The first failure in list order ends the run with kExitTrouble; with --keep-going
// all other files are processed and the exit code is kExitPartly.

namespace krok {

// Whether a command line asks for batch mode.
bool is_for_many(const std::vector<std::string>& arguments);

// `line` has been parsed with Form::many.
int run_batch(const MakeToolSpec& make_spec, const CommandLine& line);

}  // namespace krok
