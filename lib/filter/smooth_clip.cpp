#include "filter/smooth_clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers.h"
#include "core/parallel.h"
#include "math/dense_solve.h"
#include "math/quaternion.h"
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

namespace {

// The weights take window^2 values.
constexpr int kLargestWindow = 2001;

}  // namespace

Status check(const SavitzkyGolay& filter) {
  if (filter.window < 1 || filter.window % 2 == 0 || filter.window > kLargestWindow) {
    return Error("filter-window", fmt::format("invalid window of {} frames", filter.window),
                 fmt::format("use an odd number from 1 to {}", kLargestWindow));
  }
  constexpr int kHighest = 12;
  if (filter.degree < 0 || filter.degree >= filter.window || filter.degree > kHighest) {
    return Error("filter-degree",
                 fmt::format("a polynomial of degree {} cannot be fitted to {} frames",
                             filter.degree, filter.window),
                 fmt::format("the degree must be less than the window and at most {}", kHighest));
  }
  return {};
}

PolynomialSmoother::PolynomialSmoother(const SavitzkyGolay& filter) : window_(filter.window) {
  const int n = window_, columns = filter.degree + 1;
  // Legendre recurrence over [-1, 1]: the columns are nearly orthogonal for any degree.
  Eigen::MatrixXd basis(n, columns);
  for (int row = 0; row < n; ++row) {
    const double x = n == 1 ? 0 : 2.0 * row / (n - 1) - 1;
    basis(row, 0) = 1;
    if (columns > 1) basis(row, 1) = x;
    for (int k = 2; k < columns; ++k) {
      basis(row, k) = ((2 * k - 1) * x * basis(row, k - 1) - (k - 1) * basis(row, k - 2)) / k;
    }
  }
  const Eigen::MatrixXd q = orthonormal_columns(basis);
  weights_.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      weights_.data(), n, n) = q * q.transpose();
}

void PolynomialSmoother::smooth(std::span<double> series) const {
  const auto size = static_cast<int>(series.size());
  if (size < window_) return;
  const int half = window_ / 2;
  const std::vector<double> given(series.begin(), series.end());
  for (int i = 0; i < size; ++i) {
    const int first = std::clamp(i - half, 0, size - window_);
    const double* row = weights_.data() + static_cast<std::ptrdiff_t>(i - first) * window_;
    double sum = 0;
    for (int k = 0; k < window_; ++k) sum += row[k] * given[static_cast<std::size_t>(first + k)];
    series[static_cast<std::size_t>(i)] = sum;
  }
}

namespace {

void run(const Section& s, std::span<double> series) {
  if (series.empty()) return;
  // Steady state of a constant input (direct form II transposed).
  double state2 = (s.b2 - s.a2) * series[0];
  double state1 = (s.b1 - s.a1) * series[0] + state2;
  for (double& value : series) {
    const double in = value;
    value = s.b0 * in + state1;
    state1 = s.b1 * in - s.a1 * value + state2;
    state2 = s.b2 * in - s.a2 * value;
  }
}

}  // namespace

Result<std::vector<Section>> design(const Butterworth& filter, double rate) {
  if (filter.order < 2 || filter.order > 8 || filter.order % 2 != 0) {
    return Error("filter-order", fmt::format("invalid Butterworth filter order {}", filter.order),
                 "the order of both passes together must be 2, 4, 6 or 8");
  }
  const int poles = filter.order / 2;
  if (!(filter.cutoff > 0) || !std::isfinite(filter.cutoff) || !(filter.cutoff < rate / 2)) {
    return Error("filter-cutoff",
                 fmt::format("a cutoff of {} Hz is not between 0 and {} Hz, half the frame rate",
                             readable(filter.cutoff), readable(rate / 2)),
                 "6 Hz to 12 Hz suit human motion");
  }
  // |H|^2 of one pass is 1 / (1 + (w / corner)^(2 poles)); two passes square it.
  const double correction = std::pow(std::numbers::sqrt2 - 1, -1.0 / (2 * poles));
  const double w = std::tan(std::numbers::pi * filter.cutoff / rate) * correction;
  std::vector<Section> sections;
  for (int pair = 0; pair < poles / 2; ++pair) {
    const double damping = 2 * std::cos(std::numbers::pi * (poles - 1 - 2 * pair) / (2.0 * poles));
    const double scale = 1 / (1 + damping * w + w * w);
    const double b = w * w * scale;
    sections.push_back({b, 2 * b, b, 2 * (w * w - 1) * scale, (1 - damping * w + w * w) * scale});
  }
  if (poles % 2 != 0) {
    const double scale = 1 / (1 + w);
    sections.push_back({w * scale, w * scale, 0, (w - 1) * scale, 0});
  }
  return sections;
}

void filter_both_ways(std::span<const Section> sections, int padding, std::span<double> series) {
  const auto size = static_cast<std::ptrdiff_t>(series.size());
  if (size < 2) return;
  const std::ptrdiff_t pad = std::clamp<std::ptrdiff_t>(padding, 0, size - 1);
  std::vector<double> longer(static_cast<std::size_t>(size + 2 * pad));
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(longer.size()); ++i) {
    const std::ptrdiff_t k = i - pad;
    const auto at = [&](std::ptrdiff_t place) { return series[static_cast<std::size_t>(place)]; };
    longer[static_cast<std::size_t>(i)] = k < 0       ? 2 * at(0) - at(-k)
                                          : k >= size ? 2 * at(size - 1) - at(2 * (size - 1) - k)
                                                      : at(k);
  }
  for (int pass = 0; pass < 2; ++pass) {
    for (const Section& section : sections) run(section, longer);
    std::ranges::reverse(longer);
  }
  std::copy_n(longer.begin() + pad, size, series.begin());
}

int padding_for(const Butterworth& filter, double rate) {
  return static_cast<int>(std::min(1e6, std::ceil(3 * rate / filter.cutoff)));
}

void smooth_positions(const SeriesFilter& filter, std::span<Vec3> series) {
  const std::size_t size = series.size();
  if (size < 3) return;
  const Vec3 first = series.front();
  const Vec3 step = (series.back() - first) / static_cast<double>(size - 1);
  std::vector<double> values(size);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t t = 0; t < size; ++t) {
      values[t] = series[t][axis] - (first[axis] + static_cast<double>(t) * step[axis]);
    }
    filter(values);
    for (std::size_t t = 0; t < size; ++t) {
      series[t][axis] = values[t] + (first[axis] + static_cast<double>(t) * step[axis]);
    }
  }
}

void smooth_rotations(const SeriesFilter& filter, std::span<Quat> series) {
  const std::size_t size = series.size();
  if (size < 3) return;
  constexpr int kRounds = 3;
  const std::vector<Quat> data(series.begin(), series.end());
  std::vector<Vec3> rolled_out(size), filtered(size);
  for (int round = 0; round < kRounds; ++round) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t t = 0; t < size; ++t) {
      if (t > 0) sum += rotation_vector(series[t - 1].conjugate() * series[t]);
      rolled_out[t] = sum;
      filtered[t] = sum + rotation_vector(series[t].conjugate() * data[t]);
    }
    smooth_positions(filter, filtered);
    for (std::size_t t = 0; t < size; ++t) {
      series[t] =
          normalized_or_identity(series[t] * from_rotation_vector(filtered[t] - rolled_out[t]));
    }
  }
}

}  // namespace krok::filter
