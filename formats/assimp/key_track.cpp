#include <cmath>

#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/key_track_internal.h"

namespace krok::assimp {

VectorTrack vector_track(const aiVectorKey* keys, unsigned count, double seconds_per_tick,
                         KeyFaults& faults) {
  VectorTrack track;
  for (unsigned k = 0; k < count; ++k) {
    const double time = keys[k].mTime * seconds_per_tick;
    const Vec3 value = to_vector(keys[k].mValue);
    if (!std::isfinite(time) || std::abs(time) > 1e9 || !value.allFinite()) {
      ++faults.not_finite;
      continue;
    }
    track.times.push_back(time);
    track.values.push_back(value);
  }
  tidy(track, faults);
  return track;
}

RotationTrack rotation_track(const aiQuatKey* keys, unsigned count, double seconds_per_tick,
                             KeyFaults& faults) {
  RotationTrack track;
  for (unsigned k = 0; k < count; ++k) {
    const double time = keys[k].mTime * seconds_per_tick;
    const aiQuaternion& q = keys[k].mValue;
    const Quat value(static_cast<double>(q.w), static_cast<double>(q.x), static_cast<double>(q.y),
                     static_cast<double>(q.z));
    const double length = value.norm();
    if (!std::isfinite(time) || std::abs(time) > 1e9 || !(length > 1e-6) ||
        !std::isfinite(length)) {
      ++faults.not_finite;
      continue;
    }
    track.times.push_back(time);
    track.values.push_back(normalized_or_identity(value));
  }
  tidy(track, faults);
  return track;
}

}  // namespace krok::assimp
