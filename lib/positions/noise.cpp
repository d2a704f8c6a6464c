#include <algorithm>
#include <cmath>

#include "positions/from_positions.h"

namespace krok {

namespace {

// Of the second differences over a step, summed over the coordinates.
double mean_square_difference(std::span<const Vec3> track, std::size_t step) {
  double sum = 0;
  for (std::size_t t = step; t + step < track.size(); ++t) {
    sum += (track[t - step] - 2 * track[t] + track[t + step]).squaredNorm();
  }
  return sum / static_cast<double>(track.size() - 2 * step);
}

// The least x of |x - track|^2 + weight |second differences of x|^2: a system with five diagonals.
void smooth_by(double weight, std::span<Vec3> track) {
  const std::size_t n = track.size();
  std::vector<double> pivots(n), first(n), second(n);
  const auto row = [&](std::size_t i, std::size_t k) {  // element (i, i - k) of the system
    double sum = k == 0 ? 1 : 0;
    for (std::size_t d = i < 2 ? 0 : i - 2; d <= i && d + 2 < n; ++d) {
      constexpr double kDifference[] = {1, -2, 1};
      if (i - k >= d && i - d <= 2) sum += weight * kDifference[i - d] * kDifference[i - k - d];
    }
    return sum;
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 1) second[i] = row(i, 2) / pivots[i - 2];
    if (i > 0) {
      first[i] = row(i, 1);
      if (i > 1) first[i] -= second[i] * pivots[i - 2] * first[i - 1];
      first[i] /= pivots[i - 1];
    }
    pivots[i] = row(i, 0);
    if (i > 0) pivots[i] -= first[i] * first[i] * pivots[i - 1];
    if (i > 1) pivots[i] -= second[i] * second[i] * pivots[i - 2];
    if (i > 0) track[i] -= first[i] * track[i - 1];
    if (i > 1) track[i] -= second[i] * track[i - 2];
  }
  for (std::size_t i = n; i-- > 0;) {
    track[i] /= pivots[i];
    if (i + 1 < n) track[i] -= first[i + 1] * track[i + 1];
    if (i + 2 < n) track[i] -= second[i + 2] * track[i + 2];
  }
}

}  // namespace

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

// Where a track jumps to another place, as after a rest pose in the first frame.
std::vector<std::size_t> jumps_of(std::span<const Vec3> track, double noise) {
  std::vector<double> steps;
  for (std::size_t t = 1; t < track.size(); ++t) steps.push_back((track[t] - track[t - 1]).norm());
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  std::vector<std::size_t> jumps;
  for (std::size_t t = 0; t < steps.size(); ++t) {
    if (steps[t] > std::max(10 * *middle, 20 * noise)) jumps.push_back(t + 1);
  }
  return jumps;
}

bool smooth_part(std::span<Vec3> track, double noise, double rate) {
  if (track.size() < 5) return false;
  // How much the movement accelerates, over as long a step as shows it beyond the noise.
  const double of_noise = 3 * 6 * noise * noise;
  const std::size_t longest =
      std::clamp<std::size_t>(static_cast<std::size_t>(0.2 * rate), 1, track.size() / 4);
  std::size_t step = 1;
  double square = mean_square_difference(track, step);
  while (2 * step <= longest && square < 3 * of_noise) {
    step *= 2;
    square = mean_square_difference(track, step);
  }
  const auto k = static_cast<double>(step);
  // Random steps of velocity, seen over k of them.
  const double steps = std::max(square - of_noise, 0.05 * of_noise) * 3 / (k * (2 * k * k + 1));
  const double weight = std::min(3 * noise * noise / steps, 1e8);
  if (weight < 1e-4) return false;
  smooth_by(weight, track);
  return true;
}

}  // namespace

bool smooth_track(std::span<Vec3> track, double noise, double rate) {
  if (track.size() < 5 || !(noise > 0)) return false;
  bool changed = false;
  std::size_t begin = 0;
  for (const std::size_t end : jumps_of(track, noise)) {
    changed = smooth_part(track.subspan(begin, end - begin), noise, rate) || changed;
    begin = end;
  }
  return smooth_part(track.subspan(begin), noise, rate) || changed;
}

}  // namespace krok
