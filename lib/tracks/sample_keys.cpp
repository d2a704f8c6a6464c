#include "tracks/sample_keys.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "math/quaternion.h"

namespace krok {

namespace {

// The remainder in [0, period). fmod of a tiny negative number plus the period may round to the
// period itself.
double remainder_from_zero(double time, double period) {
  double rest = std::fmod(time, period);
  if (rest < 0) rest += period;
  return rest < period ? rest : 0;
}

}  // namespace

double wrap_time(double time, double duration, Wrap wrap) {
  if (!(duration > 0) || !std::isfinite(duration) || std::isnan(time)) return 0;
  if (time >= 0 && time <= duration) return time;
  if (wrap == Wrap::clamp) return std::clamp(time, 0.0, duration);
  if (!std::isfinite(time)) return 0;
  if (wrap == Wrap::loop) return remainder_from_zero(time, duration);
  const double there_and_back = remainder_from_zero(time, 2 * duration);
  return there_and_back <= duration ? there_and_back : 2 * duration - there_and_back;
}

namespace {

// A time between two keys; `part` is 0 at the key itself, and before the first and after the last
// key.
struct KeyInterval {
  std::size_t key = 0;
  double part = 0;
  double span = 1;  // seconds to the next key
};

KeyInterval find_place(std::span<const double> times, double time, std::size_t& cursor) {
  if (!(time > times.front())) return {};
  cursor = key_before(times, time, cursor);
  if (cursor + 1 == times.size()) return {cursor, 0, 1};
  const double span = times[cursor + 1] - times[cursor];
  return {cursor, (time - times[cursor]) / span, span};
}

Vec3 value_at(const VectorTrack& track, double time, std::size_t& cursor) {
  const auto [k, part, span] = find_place(track.times, time, cursor);
  const Vec3& value = track.values[k];
  if (part == 0 || track.curve == VectorCurve::step) return value;
  const Vec3& next = track.values[k + 1];
  if (track.curve == VectorCurve::linear) return value + part * (next - value);
  return hermite(value, track.velocities[k], next, track.velocities[k + 1], span, part);
}

Quat value_at(const RotationTrack& track, double time, std::size_t& cursor) {
  const auto [k, part, span] = find_place(track.times, time, cursor);
  const Quat& value = track.values[k];
  if (part == 0 || track.curve == RotationCurve::step) return value;
  const Quat& next = track.values[k + 1];
  switch (track.curve) {
    case RotationCurve::nlerp:
      return nlerp(value, next, part);
    case RotationCurve::squad:
      return squad(value, track.velocities[k], next, track.velocities[k + 1], span, part);
    default:
      return slerp(value, next, part);
  }
}

}  // namespace

Vec3 sample_track(const VectorTrack& track, double time) {
  std::size_t cursor = 0;
  return value_at(track, time, cursor);
}

Quat sample_track(const RotationTrack& track, double time) {
  std::size_t cursor = 0;
  return value_at(track, time, cursor);
}

void sample_keys(const KeyedClip& clip, double time, Wrap wrap,
                 std::span<Transform> joint_to_parent, std::span<Vec3> scales,
                 std::span<KeyCursor> cursors) {
  assert(joint_to_parent.size() == clip.joints.size());
  assert(scales.empty() || scales.size() == clip.joints.size());
  assert(cursors.empty() || cursors.size() == clip.joints.size());
  const double moment = wrap_time(time, clip.duration, wrap);
  for (std::size_t j = 0; j < clip.joints.size(); ++j) {
    const KeyedJoint& joint = clip.joints[j];
    KeyCursor fresh;
    KeyCursor& cursor = cursors.empty() ? fresh : cursors[j];
    const bool has_position = !joint.position.times.empty();
    const bool has_rotation = !joint.rotation.times.empty();
    Transform& out = joint_to_parent[j];
    if (!has_position || !has_rotation) out = clip.skeleton.reference_local(static_cast<int>(j));
    if (has_position) out.position = value_at(joint.position, moment, cursor.position);
    if (has_rotation) out.orientation = value_at(joint.rotation, moment, cursor.rotation);
    if (scales.empty()) continue;
    scales[j] = joint.scale.times.empty() ? Vec3(Vec3::Ones())
                                          : value_at(joint.scale, moment, cursor.scale);
  }
}

void sample_keys(const KeyedClip& clip, std::span<const double> times, Wrap wrap,
                 std::span<Transform> joint_to_parent, std::span<KeyCursor> cursors) {
  const std::size_t joints = clip.joints.size();
  assert(joint_to_parent.size() == times.size() * joints);
  for (std::size_t i = 0; i < times.size(); ++i) {
    sample_keys(clip, times[i], wrap, joint_to_parent.subspan(i * joints, joints), {}, cursors);
  }
}

void scaled_local_to_world(std::span<const int> parents, std::span<const Transform> joint_to_parent,
                           std::span<const Vec3> scales, std::span<Mat4> scaled_to_world,
                           std::span<Transform> joint_to_world) {
  for (std::size_t j = 0; j < parents.size(); ++j) {
    const Transform& local = joint_to_parent[j];
    Mat4 matrix = local.matrix();
    matrix.topLeftCorner<3, 3>() *= scales[j].asDiagonal();
    Quat turn = local.orientation;
    if (parents[j] >= 0) {
      const auto parent = static_cast<std::size_t>(parents[j]);
      matrix = scaled_to_world[parent] * matrix;
      turn = joint_to_world[parent].orientation * turn;
    }
    scaled_to_world[j] = matrix;
    joint_to_world[j] = {matrix.topRightCorner<3, 1>(), turn};
  }
}

}  // namespace krok
