#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// The files of krok-lint, JSON (SPEC.md): profiles (krok.lint-profile/1), suppressions
// (krok.lint-suppressions/1) and baselines (krok.lint-baseline/1).

namespace krok::lint_files {

// What a profile says of one rule.
struct RuleChoice {
  std::string rule;  // its id
  bool use = true;
  std::optional<double> limit;  // in the rule's unit, > 0
};

// A fault that is accepted, and why.
struct Suppression {
  std::string rule;
  std::string joint;               // empty: any
  std::optional<double> from, to;  // seconds; empty: all of the motion
  std::string reason;
};

// A fault that was known when a baseline was written.
struct KnownFault {
  std::string file;  // name without folder and ending
  std::string rule, joint;
  double from = 0, to = 0;  // seconds
  bool near = false;        // nearly a fault
};

// Codes lint-structure and lint-value with line and column.
Result<std::vector<RuleChoice>> read_profile(std::string_view text);
Result<std::vector<Suppression>> read_suppressions(std::string_view text);
Result<std::vector<KnownFault>> read_baseline(std::string_view text);

std::string write_baseline(const std::vector<KnownFault>& faults);

}  // namespace krok::lint_files
