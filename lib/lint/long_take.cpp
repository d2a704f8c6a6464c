#include "lint/long_take.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/index.h"
#include "scene/frame_blocks.h"

namespace krok::lint {

namespace {

constexpr double kMargin = 10;  // seconds

// Adds a fault to the same that was found in the part before, if any: of the same joint, or, of one
// that was there in `all` frames, of any.
bool joined(const Finding& finding, bool all, std::vector<Finding>& before) {
  const auto same = std::find_if(before.rbegin(), before.rend(), [&](const Finding& one) {
    return one.rule == finding.rule && one.kind == finding.kind &&
           (all || one.joint == finding.joint) && one.first <= finding.last &&
           one.last + 1 >= finding.first;
  });
  if (same == before.rend()) return false;
  Finding both = finding.excess() > same->excess() ? finding : *same;
  both.first = std::min(finding.first, same->first), both.last = std::max(finding.last, same->last);
  both.joints = std::max(finding.joints, same->joints);
  *same = std::move(both);
  return true;
}

// The seam of a loop, from two frames at either end.
Status find_seam(const FrameSource& motion, const MotionOptions& options, const auto& judge,
                 MotionFaults& out) {
  Clip ends = *load(part_of(motion, 0, 0), 1);
  for (const int first : {0, motion.frame_count - 2}) {
    const auto end = load(part_of(motion, first, 2), 1);
    if (!end) return end.error();
    ends.positions.insert(ends.positions.end(), end->positions.begin(), end->positions.end());
    ends.orientations.insert(ends.orientations.end(), end->orientations.begin(),
                             end->orientations.end());
  }
  MotionOptions how = options;
  how.settings.enabled.fill(false);
  how.settings.enabled[static_cast<std::size_t>(Rule::loop_seam)] = true;
  for (Finding& seam : judge(ends, how).findings) {
    seam.last = seam.worst = motion.frame_count - 1;
    out.findings.push_back(std::move(seam));
  }
  return {};
}

}  // namespace

Result<MotionFaults> lint_long_take(
    const FrameSource& motion, const MotionOptions& options, int jobs,
    const std::function<MotionFaults(const Clip& part, const MotionOptions& how)>& judge,
    std::size_t part_bytes) {
  const std::size_t frame = (sizeof(Vec3f) + sizeof(Quatf)) * motion.skeleton.names.size();
  const int part = static_cast<int>(std::clamp<std::size_t>(
      part_bytes / std::max<std::size_t>(frame, 1), 16, at(std::max(16, motion.frame_count))));
  if (motion.frame_count <= part) {
    const auto clip = load(motion, jobs);
    if (!clip) return clip.error();
    return judge(*clip, options);
  }
  MotionOptions how = options;
  how.is_loop = false;
  MotionFaults out;
  const auto look = [&](const FrameRun& run) -> Status {
    MotionFaults found = judge(run.clip, how);
    for (Finding& finding : found.findings) {
      const bool is_here = finding.worst >= run.kept_begin && finding.worst < run.kept_end;
      const bool went_on = finding.first < run.kept_begin && finding.last >= run.kept_begin;
      const bool all = finding.first == 0 && finding.last == run.clip.frame_count() - 1;
      for (int* const place : {&finding.first, &finding.last, &finding.worst}) *place += run.first;
      if (went_on && joined(finding, all, out.findings)) continue;
      if (is_here || all) out.findings.push_back(std::move(finding));
    }
    for (std::string& note : found.notes) {
      const auto is_same = [&](const std::string& one) { return one.starts_with(note); };
      if (std::ranges::any_of(out.notes, is_same)) continue;
      out.notes.push_back(fmt::format("{} (in the part from {:.0f} s on)", note,
                                      (run.first + run.kept_begin) / motion.rate));
    }
    return {};
  };
  const int margin =
      static_cast<int>(std::min<double>(std::ceil(kMargin * motion.rate), motion.frame_count));
  Status status = for_each_run(motion, {part, margin}, jobs, look);
  if (status && options.is_loop && options.settings.has(Rule::loop_seam)) {
    status = find_seam(motion, options, judge, out);
  }
  if (!status) return status.error();
  std::ranges::stable_sort(out.findings, {}, [](const Finding& finding) {
    return std::tuple(static_cast<int>(finding.rule), finding.first);
  });
  return out;
}

}  // namespace krok::lint
