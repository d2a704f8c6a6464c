#include "filter/smooth_clip.h"

#include <algorithm>

#include "core/parallel.h"
#include "filter/rotation_series.h"
#include "motion/local_motion.h"

namespace krok::filter {

namespace {

Result<SeriesFilter> series_filter(const Butterworth& filter, double rate) {
  auto sections = design(filter, rate);
  if (!sections) return sections.error();
  return SeriesFilter([sections = std::move(*sections),
                       padding = padding_for(filter, rate)](std::span<double> series) {
    filter_both_ways(sections, padding, series);
  });
}

Result<SeriesFilter> series_filter(const SavitzkyGolay& filter, double) {
  if (Status status = check(filter); !status) return status.error();
  return SeriesFilter([smoother = PolynomialSmoother(filter)](std::span<double> series) {
    smoother.smooth(series);
  });
}

// Rotations are filtered three times over, so what the ends of a block change reaches three times
// as far as in one pass; with a fourth to spare.
constexpr int kReaches = 4;

int overlap_of(const Butterworth& filter, double rate) {
  return kReaches * padding_for(filter, rate);
}
int overlap_of(const SavitzkyGolay& filter, double) {
  return kReaches * filter.window;
}

bool too_short(int frames, const Smoothing& smoothing) {
  const auto* polynomial = std::get_if<SavitzkyGolay>(&smoothing);
  return frames < std::max(3, polynomial != nullptr ? polynomial->window : 0);
}

// `moving`: as of moving_joints(), of the whole motion.
void smooth_joints(const SeriesFilter& filter, std::span<const std::uint8_t> joints,
                   std::span<const std::uint8_t> moving, int jobs, LocalMotion& motion) {
  parallel_for(moving.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      if (!joints.empty() && joints[j] == 0) continue;
      smooth_rotations(filter, motion.joint_orientations(static_cast<int>(j)));
      if (moving[j] != 0) smooth_positions(filter, motion.joint_positions(static_cast<int>(j)));
    }
  });
}

Result<SeriesFilter> series_filter(const Smoothing& smoothing, double rate) {
  return std::visit([&](const auto& chosen) { return series_filter(chosen, rate); }, smoothing);
}

}  // namespace

Result<Clip> smooth(const Clip& clip, const Smoothing& smoothing,
                    std::span<const std::uint8_t> joints, int jobs) {
  const auto filter = series_filter(smoothing, clip.rate);
  if (!filter) return filter.error();
  Clip result = clip;
  if (too_short(clip.frame_count(), smoothing)) return result;
  LocalMotion motion = local_motion(clip);
  smooth_joints(*filter, joints, moving_joints(motion), jobs, motion);
  set_local_motion(motion, result);
  return result;
}

Result<FrameSource> smooth(
    const FrameSource& source, const Smoothing& smoothing, std::span<const std::uint8_t> joints,
    int jobs, const std::function<void(const FrameRun& before, const Clip& after)>& watch,
    int block_frames) {
  const auto filter = series_filter(smoothing, source.rate);
  if (!filter) return filter.error();
  if (too_short(source.frame_count, smoothing)) return source;
  auto moving = moving_joints(source, jobs);
  if (!moving) return moving.error();
  BlockSize size = {
      block_frames,
      std::visit([&](const auto& chosen) { return overlap_of(chosen, source.rate); }, smoothing)};
  return changed_in_blocks(source, size, jobs,
                           [filter = *filter, moving = *std::move(moving), jobs, watch,
                            joints = std::vector(joints.begin(), joints.end())](FrameRun& run) {
                             LocalMotion motion = local_motion(run.clip);
                             smooth_joints(filter, joints, moving, jobs, motion);
                             Clip smoothed = run.clip;
                             set_local_motion(motion, smoothed);
                             if (watch) watch(run, smoothed);
                             run.clip = std::move(smoothed);
                             return Status();
                           });
}

}  // namespace krok::filter
