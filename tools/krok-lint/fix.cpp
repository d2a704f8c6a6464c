#include "tools/krok-lint/fix.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/numbers.h"
#include "filter/spikes.h"
#include "formats/anim/anim.h"
#include "formats/io/open_motion.h"
#include "plant/plant_feet.h"
#include "tools/cli/file_name.h"
#include "tools/cli/new_folders.h"
#include "tools/cli/output_set.h"

namespace krok::cli::lint {

namespace {

using krok::lint::Finding;
using krok::lint::Rule;

bool has(const LintedFile& file, Rule rule) {
  return std::ranges::any_of(file.findings, [&](const Finding& f) { return f.rule == rule; });
}

bool can_be_mended(const LintedFile& file) {
  return has(file, Rule::pop) || has(file, Rule::flip) || has(file, Rule::foot_slide);
}

// Mends the clip; returns what was done, empty for nothing.
std::string mend(const LintedFile& file, const RoleMap& roles, int jobs, Clip& clip) {
  std::string done;
  const auto add = [&](const std::string& text) { done += (done.empty() ? "" : "; ") + text; };
  if (has(file, Rule::pop) || has(file, Rule::flip)) {
    auto removed = filter::remove_spikes(clip, {}, {}, jobs);
    if (removed && !removed->spikes.empty()) {
      clip = std::move(removed->clip);
      add(counted(static_cast<long long>(removed->spikes.size()), "spike") + " removed");
    }
  }
  if (has(file, Rule::foot_slide)) {
    auto planted = plant_feet(clip, roles);
    if (planted && planted->drift_after < planted->drift_before) {
      clip = std::move(planted->clip);
      add(fmt::format("feet planted, drift {} to {} mm", readable(1e3 * planted->drift_before, 3),
                      readable(1e3 * planted->drift_after, 3)));
    }
  }
  return done;
}

}  // namespace

Status fix_all(const Options& options, const krok::lint::MotionOptions& how,
               const std::vector<LintedFile>& files, const io::FindRoles& find_roles,
               ToolContext& context) {
  NewFolders folders;
  if (Status status = folders.make(options.fix); !status) return status;
  OutputSet outputs(context);
  std::set<std::string> names;
  Json list = Json::array();
  for (const LintedFile& file : files) {
    if (file.error || !can_be_mended(file)) continue;
    io::PlainInputs inputs;
    auto clip = io::open_motion(file.path, inputs);
    if (!clip) return clip.error();
    const auto roles = find_roles(clip->skeleton);
    if (!roles) return roles.error();
    const std::string done = mend(file, *roles, context.jobs, *clip);
    if (done.empty()) continue;
    const std::string name = std::filesystem::path(file.path).stem().string() + ".anim";
    const std::string path = (std::filesystem::path(options.fix) / name).string();
    if (!names.insert(name).second) {
      return Error("lint-fix", fmt::format("two motions would be written to {}", path),
                   "mend them one folder at a time");
    }
    clip->provenance = context.provenance();
    const Status status =
        outputs.add(path, [&](OutputFile& out) { return anim::write(*clip, {}, out); });
    if (!status) return status;
    const auto left = krok::lint::lint_motion(*clip, *roles, how).findings.size();
    context.log(fmt::format("{}: {}; {} left of {}", path, done,
                            counted(static_cast<long long>(left), "fault"), file.findings.size()));
    list.push_back({{"path", path}, {"done", done}, {"faults_left", left}});
  }
  context.report.result["fixed"] = std::move(list);
  if (Status status = outputs.finish(); !status) return status;
  folders.keep();
  return {};
}

}  // namespace krok::cli::lint
