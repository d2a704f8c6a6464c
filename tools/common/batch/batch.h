#pragma once

#include "tools/common/command_line.h"
#include "tools/common/tool.h"

// The work of a tool on many files. Each file is parsed for and run by itself, as on a command line
// of its own, on one of -j threads; what it says is told in the order of the list. Results go into
// --out-dir, in the sub-folders that their inputs are in, or where a --manifest says. A result that
// stands already, made of the same input with the same options by the same version, is left as it
// is (tools/common/batch/journal.h). The first file in the list that fails ends the run with
// kExitTrouble; with --keep-going it is kExitPartly, when all others are done.

namespace krok {

// Whether a command line is one for many files.
bool is_for_many(const std::vector<std::string>& arguments);

// `line` is parsed, in the form for many files.
int run_batch(const MakeToolSpec& make_spec, const CommandLine& line);

}  // namespace krok
