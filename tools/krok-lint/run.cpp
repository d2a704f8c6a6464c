#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <tuple>

#include "core/numbers.h"
#include "tools/cli/output_set.h"
#include "tools/krok-lint/baseline.h"
#include "tools/krok-lint/fix.h"
#include "tools/krok-lint/page.h"
#include "tools/krok-lint/reports.h"

namespace krok::cli::lint {

namespace {

using krok::lint::facts_of;
using krok::lint::Finding;

// Files that cannot be read first, then by their worst fault.
std::vector<const LintedFile*> worst_first(const std::vector<LintedFile>& files) {
  std::vector<const LintedFile*> order;
  for (const LintedFile& file : files) order.push_back(&file);
  std::ranges::stable_sort(order, [](const LintedFile* a, const LintedFile* b) {
    const auto key = [](const LintedFile& file) {
      if (file.error) return std::tuple(-2, 0.0);
      if (file.findings.empty()) return std::tuple(1, 0.0);
      const Finding& worst = file.findings.front();
      return std::tuple(facts_of(worst.rule).severity == Severity::error ? -1 : 0, -worst.excess());
    };
    return key(*a) < key(*b);
  });
  return order;
}

struct Counts {
  std::size_t unreadable = 0, faulty = 0, errors = 0, warnings = 0, known = 0, suppressed = 0;
};

Counts counts_of(const std::vector<LintedFile>& files) {
  Counts counts;
  for (const LintedFile& file : files) {
    counts.unreadable += file.error ? 1 : 0;
    counts.known += file.known, counts.suppressed += file.suppressed;
    counts.faulty += file.findings.empty() ? 0 : 1;
    for (const Finding& finding : file.findings) {
      (facts_of(finding.rule).severity == Severity::error ? counts.errors : counts.warnings) += 1;
    }
  }
  return counts;
}

Result<krok::lint::Settings> settings_of(const Options& options, ToolContext& context) {
  krok::lint::Settings settings;
  if (!options.profile.empty()) {
    if (Status status = apply_profile(options.profile, settings, context); !status) {
      return status.error();
    }
  }
  for (const auto& facts : krok::lint::rules()) {
    const std::string id(facts.id);
    const auto named = [&](const std::vector<std::string>& list) {
      return std::ranges::find(list, id) != list.end();
    };
    bool& enabled = settings.enabled[static_cast<std::size_t>(facts.rule)];
    if (!options.only.empty()) enabled = named(options.only);
    if (named(options.ignore)) enabled = false;
  }
  return settings;
}

Status leave_out_accepted(const Options& options, std::vector<LintedFile>& files,
                          ToolContext& context) {
  for (LintedFile& file : files) leave_out_suppressed(file, context);
  if (options.baseline.empty()) return {};
  const auto input = context.open_input(options.baseline);
  if (!input) return input.error();
  const auto known = lint_files::read_baseline(input->text());
  if (!known) return Error(known.error()).in_file(options.baseline);
  for (LintedFile& file : files) leave_out_known(*known, file);
  return {};
}

Status write_reports(const Options& options, const std::vector<LintedFile>& files,
                     LintedFiles order, ToolContext& context) {
  OutputSet outputs(context);
  const auto add = [&](const std::string& path, const auto& make) -> Status {
    if (path.empty()) return {};
    const std::string text = make();
    return outputs.add(path, [&](OutputFile& file) { return file.write(text); });
  };
  for (const Status& status :
       {add(options.table, [&] { return table_of(order); }),
        add(options.sarif, [&] { return sarif_of(order, version()); }),
        add(options.junit, [&] { return junit_of(order); }), add(options.save_baseline, [&] {
          return lint_files::write_baseline(known_faults(files));
        })}) {
    if (!status) return status;
  }
  if (!options.html.empty()) {
    const auto page = page_of(order, context);
    if (!page) return page.error();
    if (Status status =
            outputs.add(options.html, [&](OutputFile& file) { return file.write(*page); });
        !status) {
      return status;
    }
  }
  return outputs.finish();
}

std::string summary_of(const std::vector<LintedFile>& files, const Counts& counts) {
  const auto number = [](std::size_t count) { return static_cast<long long>(count); };
  std::string line = fmt::format(
      "{}, {} with faults: {}, {}", counted(number(files.size()), "file"), counts.faulty,
      counted(number(counts.errors), "error"), counted(number(counts.warnings), "warning"));
  if (counts.unreadable > 0) line += fmt::format("; {} unreadable", counts.unreadable);
  if (counts.known > 0) line += fmt::format("; {} known", counts.known);
  if (counts.suppressed > 0) line += fmt::format("; {} suppressed", counts.suppressed);
  return line;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (options.list_rules) {
    context.print(rules_text());
    return kExitDone;
  }
  const auto settings = settings_of(options, context);
  if (!settings) return settings.error();
  const auto find_roles = io::open_role_map(options.map, context);
  if (!find_roles) return find_roles.error();
  std::unique_ptr<Terrain> ground;
  if (!options.ground.empty()) {
    auto opened = options.ground.open(context);
    if (!opened) return opened.error();
    ground = *std::move(opened);
  }
  const auto how = judging(options, *settings, ground.get());
  std::vector<LintedFile> files = lint_all(options, how, *find_roles, context);
  if (Status status = leave_out_accepted(options, files, context); !status) return status.error();
  const auto order = worst_first(files);
  Json list = Json::array();
  for (const LintedFile* file : order) {
    context.print(console_text(*file, context.quiet));
    if (context.verbose) {
      context.diagnose_in(file->path, file->diagnostics);
      for (const std::string& note : file->notes) context.log(file->path + ": " + note);
    }
    list.push_back(json_of(*file));
  }
  const Counts counts = counts_of(files);
  context.report.result["files"] = std::move(list);
  context.report.result["errors"] = counts.errors;
  context.report.result["warnings"] = counts.warnings;
  context.report.result["unreadable"] = counts.unreadable;
  if (Status status = write_reports(options, files, order, context); !status) {
    return status.error();
  }
  if (!options.fix.empty()) {
    if (Status status = fix_all(options, how, files, *find_roles, context); !status) {
      return status.error();
    }
  }
  context.log(summary_of(files, counts));
  if (counts.unreadable == files.size()) return kExitTrouble;
  if (counts.unreadable > 0) return kExitPartly;
  return counts.faulty > 0 ? kExitNo : kExitDone;
}

}  // namespace krok::cli::lint
