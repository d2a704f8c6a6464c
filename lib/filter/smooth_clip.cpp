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

}  // namespace

Result<Clip> smooth(const Clip& clip, const Smoothing& smoothing,
                    std::span<const std::uint8_t> joints, int jobs) {
  const auto filter =
      std::visit([&](const auto& chosen) { return series_filter(chosen, clip.rate); }, smoothing);
  if (!filter) return filter.error();
  Clip result = clip;
  const auto* polynomial = std::get_if<SavitzkyGolay>(&smoothing);
  if (clip.frame_count() < std::max(3, polynomial != nullptr ? polynomial->window : 0)) {
    return result;
  }
  LocalMotion motion = local_motion(clip);
  const std::vector<std::uint8_t> moving = moving_joints(motion);
  parallel_for(moving.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      if (!joints.empty() && joints[j] == 0) continue;
      smooth_rotations(*filter, motion.joint_orientations(static_cast<int>(j)));
      if (moving[j] != 0) smooth_positions(*filter, motion.joint_positions(static_cast<int>(j)));
    }
  });
  set_local_motion(motion, result);
  return result;
}

}  // namespace krok::filter
