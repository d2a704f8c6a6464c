#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "filter/series_denoiser.h"
#include "math/window.h"
#include "positions/from_positions.h"

namespace krok {

bool fill_gaps(std::span<const int> parents, std::span<Vec3> positions) {
  const std::size_t joints = parents.size(), frames = joints == 0 ? 0 : positions.size() / joints;
  for (std::size_t j = 0; j < joints; ++j) {
    const auto origin = [&](std::size_t f) -> Vec3 {
      return parents[j] < 0 ? Vec3(0, 0, 0) : positions[f * joints + at(parents[j])];
    };
    const auto offset = [&](std::size_t f) -> Vec3 {
      return positions[f * joints + j] - origin(f);
    };
    std::size_t first = 0;  // of the frames that are not known
    for (std::size_t f = 0; f <= frames; ++f) {
      if (f < frames && !positions[f * joints + j].allFinite()) continue;
      if (f == frames && first == 0) return false;
      const Vec3 to = offset(f < frames ? f : first - 1), from = first > 0 ? offset(first - 1) : to;
      for (std::size_t g = first; g < f; ++g) {
        const double share = double(g - first + 1) / double(f - first + 1);
        Vec3 between = from + share * (to - from);
        if (parents[j] >= 0) {
          between.stableNormalize();
          between *= from.norm() + share * (to.norm() - from.norm());
        }
        positions[g * joints + j] = origin(g) + between;
      }
      first = f + 1;
    }
  }
  return true;
}

std::vector<int> remove_glitches(std::span<const int> parents, double rate,
                                 std::span<Vec3> positions) {
  constexpr double kOff = 0.05, kDeviations = 8, kLongest = 0.25;  // metres, seconds
  const std::size_t joints = parents.size(), frames = joints == 0 ? 0 : positions.size() / joints;
  const auto longest = std::max<std::size_t>(2, std::size_t(kLongest * rate));
  std::vector<std::size_t> glitches;
  std::vector<double> lengths(frames), deviations(frames);
  for (std::size_t j = 0; j < joints && frames > 2; ++j) {
    if (parents[j] < 0) continue;
    for (std::size_t f = 0; f < frames; ++f) {
      lengths[f] = (positions[f * joints + j] - positions[f * joints + at(parents[j])]).norm();
      // A gap, which is not compared.
      if (!std::isfinite(lengths[f])) lengths[f] = f == 0 ? 0 : lengths[f - 1];
    }
    const double usual = upper_median(lengths);
    for (std::size_t f = 0; f < frames; ++f) deviations[f] = std::abs(lengths[f] - usual);
    const double limit = std::max(kOff, kDeviations / 0.6745 * upper_median(deviations));
    for (std::size_t f = 0, first = 0; f < frames; first = ++f) {
      while (f < frames && deviations[f] > limit) ++f;
      if (f == first || f - first > longest) continue;
      // The end that is farther from where it was before, or will be.
      const auto away = [&](std::size_t end) {
        const Vec3& before = positions[(first > 0 ? first - 1 : f) * joints + end];
        const Vec3& after = positions[(f < frames ? f : first - 1) * joints + end];
        return (positions[(first + f) / 2 * joints + end] - 0.5 * (before + after)).norm();
      };
      const std::size_t end = away(j) < away(at(parents[j])) ? at(parents[j]) : j;
      for (std::size_t g = first; g < f; ++g) glitches.push_back(g * joints + end);
    }
  }
  std::vector<int> counts(joints, 0);
  for (const std::size_t i : glitches) {
    if (!positions[i].allFinite()) continue;  // by another bone
    positions[i].setConstant(std::nan(""));
    ++counts[i % joints];
  }
  fill_gaps(parents, positions);
  return counts;
}

std::vector<double> noise_of(std::span<const int> parents, std::span<const Vec3> tracks) {
  const std::size_t joints = parents.size(), frames = joints == 0 ? 0 : tracks.size() / joints;
  std::vector<double> variances(joints, 0), noise(joints, 0);
  std::vector<int> bones(joints, 0);
  if (frames < 5) return noise;
  std::vector<double> lengths(frames), differences(frames - 2);
  for (std::size_t j = 0; j < joints; ++j) {
    if (parents[j] < 0) continue;
    const auto parent = static_cast<std::size_t>(parents[j]);
    double longest = 0;
    for (std::size_t t = 0; t < frames; ++t) {
      lengths[t] = (tracks[j * frames + t] - tracks[parent * frames + t]).norm();
      longest = std::max(longest, lengths[t]);
    }
    if (longest < 1e-6) continue;
    for (std::size_t t = 1; t + 1 < frames; ++t) {
      differences[t - 1] = std::abs(lengths[t - 1] - 2 * lengths[t] + lengths[t + 1]);
    }
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    const double deviation = *middle / 0.6745;  // of the normal distribution
    // 1 + 4 + 1 independent terms, from two joints each.
    for (const std::size_t end : {j, parent}) {
      variances[end] += deviation * deviation / 12;
      ++bones[end];
    }
  }
  for (std::size_t j = 0; j < joints; ++j) {
    if (bones[j] > 0) noise[j] = std::sqrt(variances[j] / bones[j]);
  }
  return noise;
}

namespace {

// Where a track jumps to another place, as after a rest pose in the first frame: by a step much
// longer than those before and after, which are long, too, where a joint is fast.
std::vector<std::size_t> jumps_of(std::span<const Vec3> track, double noise) {
  constexpr std::size_t kAround = 3;
  std::vector<double> steps;
  for (std::size_t t = 1; t < track.size(); ++t) steps.push_back((track[t] - track[t - 1]).norm());
  std::vector<std::size_t> jumps;
  for (std::size_t t = 0; t < steps.size(); ++t) {
    if (steps[t] <= 20 * noise) continue;
    const std::size_t first = t - std::min(t, kAround);
    std::vector<double> near(
        steps.begin() + std::ptrdiff_t(first),
        steps.begin() + std::ptrdiff_t(std::min(t + kAround + 1, steps.size())));
    near.erase(near.begin() + std::ptrdiff_t(t - first));
    const auto middle = near.begin() + std::ptrdiff_t(near.size() / 2);
    std::nth_element(near.begin(), middle, near.end());
    if (near.empty() || steps[t] > 10 * *middle) jumps.push_back(t + 1);
  }
  return jumps;
}

// The frames [begin, end) of all joints with noise.
bool smooth_part(std::size_t begin, std::size_t end, std::span<const double> noise, double rate,
                 int jobs, std::span<Vec3> tracks) {
  constexpr std::size_t kFewest = 5;
  const std::size_t joints = noise.size(), frames = tracks.size() / joints;
  std::vector<std::size_t> noisy;
  for (std::size_t j = 0; j < joints; ++j) {
    if (noise[j] > 0) noisy.push_back(j);
  }
  if (end - begin < kFewest || noisy.empty()) return false;
  const auto rows = static_cast<Eigen::Index>(end - begin);
  Eigen::MatrixXd series(rows, 3 * std::ssize(noisy));
  const auto of = [&](std::size_t i, Eigen::Index t) -> Vec3& {
    return tracks[noisy[i] * frames + begin + static_cast<std::size_t>(t)];
  };
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    for (Eigen::Index t = 0; t < rows; ++t) {
      series.block<1, 3>(t, 3 * static_cast<Eigen::Index>(i)) =
          (of(i, t) / noise[noisy[i]]).transpose();
    }
  }
  const Eigen::MatrixXd smooth = filter::without_noise_in_parts(series, rate, jobs);
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    for (Eigen::Index t = 0; t < rows; ++t) {
      of(i, t) =
          noise[noisy[i]] * smooth.block<1, 3>(t, 3 * static_cast<Eigen::Index>(i)).transpose();
    }
  }
  return true;
}

}  // namespace

bool smooth_tracks(std::span<const double> noise, double rate, int jobs, std::span<Vec3> tracks) {
  const std::size_t joints = noise.size(), frames = joints == 0 ? 0 : tracks.size() / joints;
  std::vector<std::size_t> ends;
  for (std::size_t j = 0; j < joints; ++j) {
    const auto jumps = jumps_of(tracks.subspan(j * frames, frames), noise[j]);
    ends.insert(ends.end(), jumps.begin(), jumps.end());
  }
  ends.push_back(frames);
  std::ranges::sort(ends);
  bool changed = false;
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    changed = smooth_part(begin, end, noise, rate, jobs, tracks) || changed;
    begin = end;
  }
  return changed;
}

}  // namespace krok
