#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/lint/lint.h"
#include "tools/krok-lint/linted_file.h"

// Which faults do not count: those of a baseline and suppressed ones.

namespace krok::cli::lint {

// A fault's identity: the file's name without folder and ending, the rule, and the fault's number
// among those of the rule in order of time. Sixteen hexadecimal digits.
std::string fingerprint_of(const std::string& path, std::string_view rule, int number);
// Those of a file's findings, in their order.
std::vector<std::string> fingerprints_of(const LintedFile& file);

// What --save-baseline writes.
std::vector<lint_files::KnownFault> known_faults(const std::vector<LintedFile>& files);

// Takes out findings of the same file name and rule that overlap one of the baseline's in time,
// within a quarter of a second: the worst joint of a fault and its ends may change when a motion is
// resampled.
void leave_out_known(const std::vector<lint_files::KnownFault>& known, LintedFile& file);

// Takes out what the sidecar beside each motion, NAME.lint.json, suppresses. A sidecar that cannot
// be read is the error of its motion.
void leave_out_suppressed(LintedFile& file, ToolContext& context);

// Rules and limits of a profile on top of `settings`. Codes: those of reading it, and lint-rule.
Status apply_profile(const std::string& path, krok::lint::Settings& settings, ToolContext& context);

}  // namespace krok::cli::lint
