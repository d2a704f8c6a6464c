#pragma once

#include <assimp/anim.h>

#include <algorithm>
#include <vector>

#include "math/quaternion.h"

// Assimp's keys, sorted and cleaned.

namespace krok::assimp {

// Keys of one property; times in seconds, increasing after tidy().
template <typename Value>
struct Track {
  std::vector<double> times;
  std::vector<Value> values;

  bool empty() const { return times.empty(); }
};
using VectorTrack = Track<Vec3>;
using RotationTrack = Track<Quat>;

struct KeyFaults {
  std::size_t not_finite = 0;
  std::size_t out_of_order = 0;
  std::size_t same_time = 0;
};

inline Vec3 between(const Vec3& a, const Vec3& b, double t) {
  return a + t * (b - a);
}
inline Quat between(const Quat& a, const Quat& b, double t) {
  return slerp(a, b, t);
}
inline double between(double a, double b, double t) {
  return a + t * (b - a);
}

// The value at a time, clamped to the first and last key. The track must not be empty.
template <typename Value>
Value sample_track(const Track<Value>& track, double time) {
  const auto after = std::upper_bound(track.times.begin(), track.times.end(), time);
  const auto k = static_cast<std::size_t>(after - track.times.begin());
  if (k == 0) return track.values.front();
  if (k == track.times.size()) return track.values.back();
  const double t = (time - track.times[k - 1]) / (track.times[k] - track.times[k - 1]);
  return between(track.values[k - 1], track.values[k], t);
}

// Sorts keys by time and keeps the last of those at the same time, compared as floats.
template <typename Value>
void tidy(Track<Value>& track, KeyFaults& faults) {
  std::vector<std::size_t> order(track.times.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  if (!std::is_sorted(track.times.begin(), track.times.end())) {
    ++faults.out_of_order;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return track.times[a] < track.times[b]; });
  }
  Track<Value> tidied;
  for (const std::size_t k : order) {
    const bool same = !tidied.empty() &&
                      static_cast<float>(track.times[k]) <= static_cast<float>(tidied.times.back());
    if (same) {
      ++faults.same_time;
      tidied.values.back() = track.values[k];
    } else {
      tidied.times.push_back(track.times[k]);
      tidied.values.push_back(track.values[k]);
    }
  }
  track = std::move(tidied);
}

// Removes what is before time 0 and adds a key at 0.
template <typename Value>
void begin_at_zero(Track<Value>& track) {
  if (track.empty() || track.times.front() >= 0) return;
  const Value at_zero = sample_track(track, 0.0);
  Track<Value> cut;
  cut.times.push_back(0.0);
  cut.values.push_back(at_zero);
  for (std::size_t k = 0; k < track.times.size(); ++k) {
    if (static_cast<float>(track.times[k]) <= 0) continue;
    cut.times.push_back(track.times[k]);
    cut.values.push_back(track.values[k]);
  }
  track = std::move(cut);
}

// Keys with a time or value that is not finite, or absurdly large, are left out.
VectorTrack vector_track(const aiVectorKey* keys, unsigned count, double seconds_per_tick,
                         KeyFaults& faults);
RotationTrack rotation_track(const aiQuatKey* keys, unsigned count, double seconds_per_tick,
                             KeyFaults& faults);

}  // namespace krok::assimp
