#include "tools/krok-lint/linted_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"

namespace krok::cli::lint {

namespace {

using krok::lint::facts_of;
using krok::lint::Finding;

constexpr double kNear = 0.25;  // seconds
// Other rates and exports move values by so much: with a baseline, faults count from there on.
constexpr double kDoubtful = 1.15;  // times the limit
constexpr double kNearlyKnown = 2;  // times the limit, of what was nearly over it

std::string stem_of(const LintedFile& file) {
  const std::string stem = to_utf8(std::filesystem::path(file.path).stem().string());
  return stem + (file.animation.empty() ? "" : ": " + file.animation);
}

bool overlap(double from, double to, double other_from, double other_to) {
  return from <= other_to + kNear && other_from <= to + kNear;
}

std::string sidecar_of(const std::string& path) {
  return path == "-" ? "" : std::filesystem::path(path).replace_extension(".lint.json").string();
}

}  // namespace

Status check_rule(const std::string& id, const std::string& path) {
  if (krok::lint::find_rule(id)) return {};
  std::vector<std::string> ids;
  for (const auto& facts : krok::lint::rules()) ids.emplace_back(facts.id);
  return Error("lint-rule", fmt::format("'{}' is no rule", shown(id)), nearest_hint(id, ids))
      .in_file(path);
}

std::string fingerprint_of(const LintedFile& file, std::string_view rule, int number) {
  const std::string text = fmt::format("{}|{}|{}", stem_of(file), rule, number);
  return hex(xxh3(std::as_bytes(std::span(text))));
}

std::vector<std::string> fingerprints_of(const LintedFile& file) {
  std::vector<std::string> prints;
  for (const Finding& finding : file.findings) {
    const auto before = std::ranges::count_if(file.findings, [&](const Finding& other) {
      return other.rule == finding.rule && other.first < finding.first;
    });
    prints.push_back(fingerprint_of(file, facts_of(finding.rule).id, static_cast<int>(before)));
  }
  return prints;
}

std::vector<lint_files::KnownFault> known_faults(const std::vector<LintedFile>& files) {
  std::vector<lint_files::KnownFault> known;
  for (const LintedFile& file : files) {
    for (const auto* findings : {&file.findings, &file.near}) {
      for (const Finding& finding : *findings) {
        known.push_back({stem_of(file), std::string(facts_of(finding.rule).id),
                         file.joint_of(finding), file.seconds(finding.first),
                         file.seconds(finding.last), findings == &file.near});
      }
    }
  }
  return known;
}

void leave_out_known(const std::vector<lint_files::KnownFault>& known, LintedFile& file) {
  const std::string stem = stem_of(file);
  file.known += std::erase_if(file.findings, [&](const Finding& finding) {
    const double excess = finding.threshold > 0 ? finding.excess() : kDoubtful;
    if (excess > 1 && excess < kDoubtful) return true;
    return std::ranges::any_of(known, [&](const lint_files::KnownFault& fault) {
      return fault.file == stem && fault.rule == facts_of(finding.rule).id &&
             (!fault.near || (finding.threshold > 0 && excess < kNearlyKnown)) &&
             overlap(fault.from, fault.to, file.seconds(finding.first), file.seconds(finding.last));
    });
  });
}

void leave_out_suppressed(LintedFile& file, ToolContext& context) {
  const std::string path = sidecar_of(file.path);
  std::error_code ignored;
  if (file.error || path.empty() || !std::filesystem::is_regular_file(path, ignored)) return;
  const auto input = context.open_input(path);
  if (!input) {
    file.error = input.error();
    return;
  }
  auto suppressions = lint_files::read_suppressions(input->text());
  if (!suppressions) {
    file.error = std::move(suppressions).error().in_file(path);
    return;
  }
  for (const lint_files::Suppression& one : *suppressions) {
    if (Status status = check_rule(one.rule, path); !status) file.error = std::move(status).error();
    if (one.joint.empty() || std::ranges::find(file.joints, one.joint) != file.joints.end())
      continue;
    context.diagnose_in(
        path,
        {make_warning("lint-joint", fmt::format("the motion has no joint '{}'", shown(one.joint)),
                      nearest_hint(one.joint, file.joints))});
  }
  file.suppressed += std::erase_if(file.findings, [&](const Finding& finding) {
    return std::ranges::any_of(*suppressions, [&](const lint_files::Suppression& one) {
      return one.rule == facts_of(finding.rule).id &&
             (one.joint.empty() || one.joint == file.joint_of(finding)) &&
             overlap(one.from.value_or(0), one.to.value_or(1e9), file.seconds(finding.first),
                     file.seconds(finding.last));
    });
  });
}

Status apply_profile(const std::string& path, krok::lint::Settings& settings,
                     ToolContext& context) {
  const auto input = context.open_input(path);
  if (!input) return input.error();
  const auto choices = lint_files::read_profile(input->text());
  if (!choices) return Error(choices.error()).in_file(path);
  for (const lint_files::RuleChoice& choice : *choices) {
    if (Status status = check_rule(choice.rule, path); !status) return status;
    const auto i = static_cast<std::size_t>(*krok::lint::find_rule(choice.rule));
    settings.enabled[i] = choice.use;
    if (choice.limit) settings.thresholds[i] = *choice.limit;
  }
  return {};
}

}  // namespace krok::cli::lint
