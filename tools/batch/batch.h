#pragma once

#include "tools/cli/command_line.h"
#include "tools/cli/tool.h"

// Batch mode: a tool processes many files. Each file is parsed and run independently, as on its own
// command line, on one of -j threads; messages are printed in list order. Outputs go into
// --out-dir, in the same sub-folders as their inputs, or where a --manifest says. An output that is
// up to date, made from the same input with the same options by the same version, is skipped
// (journal.h). The first failure in list order ends the run with kExitTrouble; with --keep-going
// all other files are processed and the exit code is kExitPartly.

namespace krok::cli::batch {

// cli::run_tool for a tool whose spec has a Batch: one file, or many with --out-dir or --manifest.
int run_tool(const MakeToolSpec& make_spec, int argc, char** argv);

}  // namespace krok::cli::batch
