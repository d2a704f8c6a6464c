#include "tracks/reduce_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/parallel.h"
#include "tracks/key_reducer_internal.h"

namespace krok {

namespace {

using tracks_detail::kTracksPerJoint;
using tracks_detail::ReductionTask;
using tracks_detail::StretchResult;

// Long motions are reduced in chunks of this many frames, which share their border frames.
constexpr std::size_t kStretch = 1024;

Status check(const ReduceOptions& options) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance) ||
      !(options.shell_distance >= 0) || !std::isfinite(options.shell_distance) ||
      !(options.most_kept >= 0)) {
    return Error(
        "reduce-tolerance",
        fmt::format("tolerance {} m, shell distance {} m, max fraction kept {}; the first must "
                    "be positive, the others must not be negative",
                    options.tolerance, options.shell_distance, options.most_kept));
  }
  return {};
}

// The joints of tracks that keys are removed from, with their descendants. Each removal places all
// of these, so skeletons in which they are too many are refused.
Result<std::vector<std::vector<int>>> joints_below(const ReductionTask& task) {
  constexpr std::size_t kMaxPairs = 1'000'000;
  const std::size_t joints = task.parents.size();
  const auto at = [](int joint) { return static_cast<std::size_t>(joint); };
  std::vector<int> above(joints, -1);  // the next such joint from here on upwards
  std::vector<std::size_t> depth(joints, 0);
  std::size_t pairs = 0;
  for (std::size_t j = 0; j < joints; ++j) {
    const int parent = task.parents[j];
    const bool moves = task.keep[kTracksPerJoint * j] == tracks_detail::Keep::needed ||
                       task.keep[kTracksPerJoint * j + 1] == tracks_detail::Keep::needed;
    depth[j] = (parent < 0 ? 0 : depth[at(parent)]) + (moves ? 1 : 0);
    above[j] = moves ? static_cast<int>(j) : parent < 0 ? -1 : above[at(parent)];
    pairs += depth[j];
  }
  if (pairs > kMaxPairs) {
    return Error(
        "reduce-joints",
        fmt::format("{} joints are too deep below each other for their keys to be reduced: "
                    "{} pairs of one below another that moves, at most {}",
                    joints, pairs, kMaxPairs),
        "export without reducing keys");
  }
  std::vector<std::vector<int>> below(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    for (int a = above[j]; a >= 0;) {
      below[at(a)].push_back(static_cast<int>(j));
      const int parent = task.parents[at(a)];
      a = parent < 0 ? -1 : above[at(parent)];
    }
  }
  return below;
}

// Which tracks need more than the rest value or that of the first frame: those whose change alone
// would be visible. Tracks kept constant may use up to a quarter of the tolerance on the longest
// chain.
std::vector<tracks_detail::Keep> moving_tracks(const ReductionTask& task, std::size_t frames) {
  const std::size_t joints = task.parents.size();
  std::vector<std::size_t> depth(joints, 1);
  std::size_t deepest = 1;
  for (std::size_t j = 0; j < joints; ++j) {
    if (task.parents[j] >= 0) depth[j] = depth[static_cast<std::size_t>(task.parents[j])] + 1;
    deepest = std::max(deepest, depth[j]);
  }
  // Upper bound of the reach of a joint's rotation: the longest chain of bones below it.
  std::vector<double> reach(joints), longest(joints, 0);
  for (std::size_t j = 0; j < joints; ++j) reach[j] = task.shell_of(j);
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      longest[j] = std::max(longest[j], task.local[f * joints + j].position.norm());
    }
  }
  for (std::size_t j = joints; j-- > 0;) {
    if (task.parents[j] < 0) continue;
    double& above = reach[static_cast<std::size_t>(task.parents[j])];
    above = std::max(above, reach[j] + longest[j]);
  }
  const double still =
      0.25 * task.options.tolerance / static_cast<double>(kTracksPerJoint * deepest);
  using tracks_detail::Keep;
  std::vector<Keep> keep(kTracksPerJoint * joints,
                         task.options.rest.empty() ? Keep::first : Keep::rest);
  const auto need = [&](std::span<const Transform> from, Keep now, Keep then) {
    for (std::size_t f = 0; f < frames; ++f) {
      for (std::size_t j = 0; j < joints; ++j) {
        const Transform& here = task.local[f * joints + j];
        Keep& position = keep[kTracksPerJoint * j];
        Keep& rotation = keep[kTracksPerJoint * j + 1];
        if (position == now && (here.position - from[j].position).norm() > still) position = then;
        if (rotation == now && tracks_detail::rotation_error(from[j].orientation, here.orientation,
                                                             reach[j]) > still) {
          rotation = then;
        }
      }
    }
  };
  if (!task.options.rest.empty()) need(task.options.rest, Keep::rest, Keep::first);
  need(task.local.first(joints), Keep::first, Keep::needed);
  return keep;
}

// Appends the keys of a chunk to those of the chunks before it.
void append(const StretchResult& stretch, Reduction& reduction) {
  for (std::size_t track = 0; track < stretch.keys.size(); ++track) {
    KeptFrames& joint = reduction.joints[track / kTracksPerJoint];
    auto& kept = track % kTracksPerJoint == 0 ? joint.position : joint.rotation;
    for (const int frame : stretch.keys[track]) {
      if (kept.empty() || frame > kept.back()) kept.push_back(frame);
    }
  }
  if (stretch.largest_error <= reduction.largest_error) return;
  reduction.largest_error = stretch.largest_error;
  reduction.worst_joint = stretch.worst_joint;
  reduction.worst_frame = stretch.worst_frame;
}

Reduction reduce_all(const ReductionTask& task, int jobs) {
  const std::size_t frames = task.times.size();
  const std::size_t stretches = std::max<std::size_t>((frames + kStretch - 2) / kStretch, 1);
  std::vector<StretchResult> results(stretches);
  parallel_for(stretches, 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      results[s] = tracks_detail::reduce_stretch(task, s * kStretch,
                                                 std::min((s + 1) * kStretch + 1, frames));
    }
  });
  Reduction reduction;
  reduction.joints.resize(task.parents.size());
  reduction.keys_before = task.keep.size() * frames;
  for (const StretchResult& stretch : results) append(stretch, reduction);
  return reduction;
}

// Marks the tracks that keep too many keys to be worth separate times. Returns whether any was
// newly marked.
bool keep_all_where_few_go(const ReduceOptions& options, const Reduction& reduction,
                           ReductionTask& task) {
  const double most = options.most_kept * static_cast<double>(task.times.size());
  bool any = false;
  for (std::size_t track = 0; track < task.keep.size(); ++track) {
    const KeptFrames& joint = reduction.joints[track / kTracksPerJoint];
    const auto& kept = track % kTracksPerJoint == 0 ? joint.position : joint.rotation;
    if (task.keep[track] == tracks_detail::Keep::needed &&
        static_cast<double>(kept.size()) > most) {
      task.keep[track] = tracks_detail::Keep::all;
      any = true;
    }
  }
  return any;
}

}  // namespace

Result<Reduction> choose_keys(std::span<const int> parents, std::span<const double> times,
                              std::span<const Transform> joint_to_parent,
                              const ReduceOptions& options, int jobs) {
  if (Status status = check(options); !status) return status.error();
  const std::size_t joints = parents.size(), frames = times.size();
  assert(joint_to_parent.size() == joints * frames);
  if (frames == 0 || joints == 0) {
    Reduction nothing;
    nothing.joints.resize(joints);
    return nothing;
  }
  ReductionTask task{parents, times, joint_to_parent, {}, {}, options};
  task.keep = moving_tracks(task, frames);
  if (options.most_kept == 0) {
    std::ranges::replace(task.keep, tracks_detail::Keep::needed, tracks_detail::Keep::all);
  }
  auto below = joints_below(task);
  if (!below) return below.error();
  task.below = *std::move(below);
  if (!options.rest.empty() && options.most_kept > 0 && frames <= kStretch) {
    tracks_detail::put_to_rest(task);
  }
  Reduction reduction = reduce_all(task, jobs);
  // Tracks that get all their keys back leave more tolerance to the others, and remove errors that
  // others compensated for. So everything is reduced again, and the result of the last round is
  // valid.
  constexpr int kRounds = 4;
  for (int round = 1; round < kRounds && keep_all_where_few_go(options, reduction, task); ++round) {
    reduction = reduce_all(task, jobs);
  }
  for (std::size_t track = 0; track < task.keep.size(); ++track) {
    KeptFrames& joint = reduction.joints[track / kTracksPerJoint];
    auto& kept = track % kTracksPerJoint == 0 ? joint.position : joint.rotation;
    if (task.keep[track] == tracks_detail::Keep::first) kept.assign(1, 0);
    reduction.keys_after += kept.size();
  }
  return reduction;
}

}  // namespace krok
