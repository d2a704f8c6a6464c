#pragma once

#include <span>
#include <string>

#include "core/result.h"
#include "tools/cli/json.h"
#include "tools/krok-lint/linted_file.h"

// What was found as text for people, tables and other programs. Files in the order given.

namespace krok::cli::lint {

using LintedFiles = std::span<const LintedFile* const>;

const char* name_of(Severity severity);  // "error", "warning"

// A line for each fault: "walk.bvh: 1.20 s: warning: LeftFoot: 63 mm, limit 40 mm [foot-slide]".
std::string console_text(const LintedFile& file, bool errors_only = false);
std::string rules_text();

std::string table_of(LintedFiles files);  // CSV
Json json_of(const LintedFile& file);     // for the tool's report

// SARIF 2.1.0 (OASIS): a result for each fault, with a fingerprint (krokLint/v1) that is the same
// under another name of its folder, export, rate or unit. GitHub shows at most 25,000 results a
// run, 5,000 of them: the worst are kept, and what is left out is counted.
std::string sarif_of(LintedFiles files, const std::string& version);

// JUnit XML: a test suite for each file, a failed test case for each rule with faults.
std::string junit_of(LintedFiles files);

// An HTML page, without other files: a table of all faults, the worst file first, and for the worst
// fault of each file five images of the body around its worst moment, for the first 100 files.
Result<std::string> page_of(LintedFiles files, ToolContext& context);

}  // namespace krok::cli::lint
