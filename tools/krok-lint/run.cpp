#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <tuple>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "core/text.h"
#include "filter/spikes.h"
#include "formats/anim/anim.h"
#include "formats/io/open_character.h"
#include "formats/io/open_motion.h"
#include "plant/plant_feet.h"
#include "tools/cli/output_set.h"
#include "tools/cli/paths.h"
#include "tools/krok-lint/linted_file.h"

namespace krok::cli::lint {

namespace {

using krok::lint::facts_of;
using krok::lint::Finding;
using krok::lint::Rule;

bool has(const LintedFile& file, Rule rule) {
  return std::ranges::any_of(file.findings, [&](const Finding& f) { return f.rule == rule; });
}

// A mended motion, and what was done.
struct Repair {
  Clip clip;
  std::string done;
};

std::optional<Repair> without_spikes(const LintedFile& file, const Clip& clip, const RoleMap&,
                                     int jobs) {
  if (!has(file, Rule::pop) && !has(file, Rule::flip)) return std::nullopt;
  auto removed = filter::remove_spikes(clip, {}, {}, jobs);
  if (!removed || removed->spikes.empty()) return std::nullopt;
  return Repair{std::move(removed->clip), counted(removed->spikes.size(), "spike") + " removed"};
}

std::optional<Repair> with_planted_feet(const LintedFile& file, const Clip& clip,
                                        const RoleMap& roles, int) {
  if (!has(file, Rule::foot_slide)) return std::nullopt;
  auto planted = plant_feet(clip, roles);
  if (!planted || planted->drift_after >= planted->drift_before) return std::nullopt;
  return Repair{std::move(planted->clip), fmt::format("feet planted, drift {} to {} mm",
                                                      readable(1e3 * planted->drift_before, 3),
                                                      readable(1e3 * planted->drift_after, 3))};
}

// Of a file made for a motion, without ending.
std::string name_for(const LintedFile& file) {
  std::string name = std::filesystem::path(file.path).stem().string();
  if (!file.animation.empty()) name += "_" + file_name_of(file.animation);
  return name;
}

struct Mended {
  std::vector<std::string> done, left_out;
  std::size_t faults_before = 0, faults_left = 0;  // accepted ones, too
};

// Mends the clip step by step; steps after which it has as many faults or more are left out.
Mended mend(const LintedFile& file, const RoleMap& roles, const Options& options,
            const krok::lint::MotionOptions& how, int jobs, Clip& clip) {
  const auto count = [&](const Clip& of) {
    return faults_of(of, roles, file, options, how).findings.size();
  };
  Mended mended;
  mended.faults_before = mended.faults_left = count(clip);
  for (const auto step : {without_spikes, with_planted_feet}) {
    auto repair = step(file, clip, roles, jobs);
    if (!repair) continue;
    const std::size_t left = count(repair->clip);
    if (left >= mended.faults_left) {
      mended.left_out.push_back(fmt::format("{}: {} of {} would be left", repair->done,
                                            counted(left, "fault"), mended.faults_left));
      continue;
    }
    clip = std::move(repair->clip), mended.faults_left = left;
    mended.done.push_back(std::move(repair->done));
  }
  return mended;
}

// --fix OUT_DIR: writes NAME.anim there for each motion with faults that can be mended: spikes are
// removed as by `krok edit --spikes`, sliding feet planted as by `krok ik --plant`, each only where
// fewer faults are left. Says for each what was changed, what was left out, and how many faults are
// left when the result is judged again. Inputs stay as they are. Code lint-fix where two motions
// would have one name.
Status fix_all(const Options& options, const krok::lint::MotionOptions& how,
               const std::vector<LintedFile>& files, const io::FindRoles& find_roles,
               ToolContext& context) {
  NewFolders folders;
  if (Status status = folders.make(options.fix); !status) return status;
  OutputSet outputs(context);
  std::set<std::string> names;
  Json list = Json::array();
  for (const LintedFile& file : files) {
    const bool can_be =
        has(file, Rule::pop) || has(file, Rule::flip) || has(file, Rule::foot_slide);
    if (file.error || !can_be) continue;
    io::PlainInputs inputs;
    auto actor = io::open_actor(file.path, inputs, {.clip = file.animation, .with_mesh = false});
    if (!actor) return actor.error();
    Clip& clip = actor->motions.front().clip;
    const auto roles = find_roles(clip.skeleton);
    if (!roles) return roles.error();
    const Mended mended = mend(file, *roles, options, how, context.jobs, clip);
    std::string left_out;
    for (const std::string& step : mended.left_out) left_out += "; left out: " + step;
    if (mended.done.empty()) {
      if (!left_out.empty()) context.log(file.name() + ": nothing mended" + left_out);
      continue;
    }
    const std::string name = name_for(file) + ".anim";
    const std::string path = (std::filesystem::path(options.fix) / name).string();
    if (!names.insert(name).second) {
      return Error("lint-fix", fmt::format("two motions would be written to {}", path),
                   "mend them one folder at a time");
    }
    clip.provenance = context.provenance();
    const Status status =
        outputs.add(path, [&](OutputFile& out) { return anim::write(clip, {}, out); });
    if (!status) return status;
    const std::string done = fmt::format("{}", fmt::join(mended.done, "; "));
    context.log(fmt::format("{}: {}; {} left of {}{}", path, done,
                            counted(mended.faults_left, "fault"), mended.faults_before, left_out));
    list.push_back({{"path", path},
                    {"done", done},
                    {"left_out", mended.left_out},
                    {"faults_left", mended.faults_left}});
  }
  context.report.result["fixed"] = std::move(list);
  if (Status status = outputs.finish(); !status) return status;
  folders.keep();
  return {};
}

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
  std::size_t files = 0, animations = 0, unreadable = 0, faulty = 0, errors = 0, warnings = 0,
              known = 0, suppressed = 0;
};

Counts counts_of(const std::vector<LintedFile>& files) {
  Counts counts;
  for (const LintedFile& file : files) {
    (file.animation.empty() ? counts.files : counts.animations) += 1;
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
  if (options.self_intersection) {
    settings.enabled[static_cast<std::size_t>(Rule::self_intersection)] = true;
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
  for (const lint_files::KnownFault& fault : *known) {
    if (Status status = check_rule(fault.rule, options.baseline); !status) return status;
  }
  for (LintedFile& file : files) leave_out_known(*known, file);
  return {};
}

// --save-pages OUT_DIR: NAME.html for each file with faults and a motion, numbered where names are
// the same. Fills `players`.
Status save_players(const Options& options, LintedFiles order, PlayerLinks& players,
                    OutputSet& outputs) {
  constexpr std::size_t kMaxPages = 100;
  namespace fs = std::filesystem;
  const fs::path from = fs::absolute(fs::path(options.html)).parent_path();
  std::set<std::string> names;
  for (const LintedFile* file : order) {
    if (file->error || file->findings.empty() || file->frames == 0) continue;
    if (players.size() == kMaxPages) break;
    const std::string stem = name_for(*file);
    std::string name = stem;
    for (int number = 2; !names.insert(name).second; ++number) {
      name = fmt::format("{}_{}", stem, number);
    }
    const fs::path path = fs::path(options.save_pages) / (name + ".html");
    const auto page = player_of(*file);
    if (!page) return page.error();
    if (Status status = outputs.add(path.string(), *page); !status) return status;
    const fs::path link = fs::absolute(path).lexically_normal().lexically_relative(from);
    players[file] = uri_of(to_utf8(link.generic_string()));
  }
  return {};
}

Status write_reports(const Options& options, const krok::lint::Settings& settings,
                     const std::vector<LintedFile>& files, LintedFiles order,
                     ToolContext& context) {
  OutputSet outputs(context);
  const auto add = [&](const std::string& path, const auto& make) -> Status {
    if (path.empty()) return {};
    const std::string text = make();
    return outputs.add(path, text);
  };
  for (const Status& status : {add(options.table, [&] { return table_of(order); }),
                               add(options.sarif, [&] { return sarif_of(order, version()); }),
                               add(options.junit, [&] { return junit_of(order, settings); }),
                               add(options.save_baseline, [&] {
                                 return lint_files::write_baseline(known_faults(files));
                               })}) {
    if (!status) return status;
  }
  NewFolders folders;
  if (!options.html.empty()) {
    PlayerLinks players;
    if (!options.save_pages.empty()) {
      if (Status status = folders.make(options.save_pages); !status) return status;
      if (Status status = save_players(options, order, players, outputs); !status) return status;
    }
    const auto page = page_of(order, players, context);
    if (!page) return page.error();
    if (Status status = outputs.add(options.html, *page); !status) return status;
  }
  if (Status status = outputs.finish(); !status) return status;
  folders.keep();
  return {};
}

std::string summary_of(const Counts& counts) {
  std::string line = counted(counts.files, "file");
  if (counts.animations > 0) line += " with " + counted(counts.animations, "animation");
  line += fmt::format(", {} with faults: {}, {}", counts.faulty, counted(counts.errors, "error"),
                      counted(counts.warnings, "warning"));
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
  const auto ground = options.ground.open(context);
  if (!ground) return ground.error();
  const auto how = judging(options, *settings, ground->get());
  std::vector<LintedFile> files = lint_all(options, how, *find_roles, context);
  if (Status status = leave_out_accepted(options, files, context); !status) return status.error();
  const auto order = worst_first(files);
  Json list = Json::array();
  for (const LintedFile* file : order) {
    context.print(console_text(*file, context.quiet));
    if (context.verbose) {
      context.diagnose_in(file->path, file->diagnostics);
      for (const std::string& note : file->notes) context.log(file->name() + ": " + note);
    }
    list.push_back(json_of(*file));
  }
  const Counts counts = counts_of(files);
  context.report.result["files"] = std::move(list);
  context.report.result["errors"] = counts.errors;
  context.report.result["warnings"] = counts.warnings;
  context.report.result["unreadable"] = counts.unreadable;
  if (Status status = write_reports(options, *settings, files, order, context); !status) {
    return status.error();
  }
  if (!options.fix.empty()) {
    if (Status status = fix_all(options, how, files, *find_roles, context); !status) {
      return status.error();
    }
  }
  context.log(summary_of(counts));
  if (counts.unreadable == files.size()) return kExitTrouble;
  if (counts.unreadable > 0) return kExitPartly;
  return counts.faulty > 0 ? kExitNo : kExitDone;
}

}  // namespace krok::cli::lint
