#include <algorithm>
#include <cmath>

#include "filter/series_denoiser.h"
#include "positions/from_positions.h"

namespace krok {

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
