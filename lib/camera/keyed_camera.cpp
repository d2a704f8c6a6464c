#include "camera/keyed_camera.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "camera/look_at.h"
#include "core/numbers.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "scene/clip.h"

namespace krok {

namespace {

// Interpolation of one camera property through its keys.

// Key data that does not depend on the type of the property.
struct KeyTimes {
  std::vector<double> times;     // seconds, strictly increasing
  std::vector<Between> between;  // [keys], from each to the next; the last one is unused
  std::vector<double> tensions;  // [keys]
  bool closed = false;           // all keys are smooth and the last equals the first
};

// The keys of one smooth curve: index of the first, and count.
struct SmoothRun {
  std::size_t first = 0, count = 0;
};

// A time relative to the keys: the interval from `key` to the next, and the interpolation weight
// `t` after easing (0 for step and at the last key). Clamped to the keys.
struct Moment {
  std::size_t key = 0;
  double t = 0;     // in [0, 1)
  double span = 1;  // seconds from key to the next
  bool smooth = false;
};

std::vector<SmoothRun> smooth_runs(const KeyTimes& keys) {
  std::vector<SmoothRun> runs;
  const std::size_t count = keys.times.size();
  for (std::size_t first = 0; first + 1 < count;) {
    std::size_t last = first;
    while (last + 1 < count && keys.between[last] == Between::smooth) ++last;
    if (last > first) runs.push_back({first, last - first + 1});
    first = std::max(last, first + 1);
  }
  return runs;
}

Moment moment_at(const KeyTimes& keys, double time) {
  Moment moment;
  moment.key = key_before(keys.times, time);
  const bool within = moment.key + 1 < keys.times.size() && time > keys.times[moment.key];
  if (!within) return moment;
  moment.span = keys.times[moment.key + 1] - keys.times[moment.key];
  const double t = (time - keys.times[moment.key]) / moment.span;
  switch (keys.between[moment.key]) {
    case Between::smooth:
      moment.smooth = true;
      moment.t = t;
      break;
    case Between::linear:
      moment.t = t;
      break;
    case Between::ease:
      moment.t = t * t * (3 - 2 * t);
      break;
    case Between::step:
      break;
  }
  return moment;
}

// Values with a velocity at each key for the curves that start and end there; within a run both are
// the same. `Kind` has Value, Velocity, velocities(times, values, ends, velocities), smooth(...)
// and straight(from, to, t).
template <typename Kind>
class KeyedCurve {
 public:
  using Value = typename Kind::Value;
  using Velocity = typename Kind::Velocity;

  KeyedCurve(KeyTimes keys, std::vector<Value> values)
      : keys_(std::move(keys)), values_(std::move(values)), velocities_(values_.size()) {
    for (const SmoothRun& run : smooth_runs(keys_)) {
      const auto part = [&run](auto& list) {
        return std::span(list).subspan(run.first, run.count);
      };
      std::vector<Velocity> velocities(run.count);
      Kind::velocities(std::span<const double>(part(keys_.times)),
                       std::span<const Value>(part(values_)),
                       keys_.closed ? Ends::closed : Ends::open, velocities);
      for (std::size_t i = 0; i < run.count; ++i) {
        const std::size_t key = run.first + i;
        velocities_[key] = (1 - keys_.tensions[key]) * velocities[i];
      }
    }
  }

  Value at(double time) const {
    const Moment moment = moment_at(keys_, time);
    const std::size_t k = moment.key;
    if (moment.t == 0) return values_[k];
    if (!moment.smooth) return Kind::straight(values_[k], values_[k + 1], moment.t);
    return Kind::smooth(values_[k], velocities_[k], values_[k + 1], velocities_[k + 1], moment.span,
                        moment.t);
  }

 private:
  KeyTimes keys_;
  std::vector<Value> values_;
  std::vector<Velocity> velocities_;
};

constexpr double kMaxFrames = 1e7;

// Values interpolated by addition: positions and numbers.
template <typename T>
struct Sum {
  using Value = T;
  using Velocity = T;
  static void velocities(std::span<const double> times, std::span<const T> values, Ends ends,
                         std::span<T> out) {
    tension_velocities(times, values, 0, ends, out);
  }
  static T smooth(const T& p0, const T& v0, const T& p1, const T& v1, double span, double t) {
    return hermite(p0, v0, p1, v1, span, t);
  }
  static T straight(const T& from, const T& to, double t) { return from + t * (to - from); }
};

using Point = Sum<Vec3>;
using Number = Sum<double>;

struct MonotoneNumber : Number {
  static void velocities(std::span<const double> times, std::span<const double> values, Ends ends,
                         std::span<double> out) {
    monotone_velocities(times, values, ends, out);
  }
};

struct Rotation {
  using Value = Quat;
  using Velocity = Vec3;
  static void velocities(std::span<const double> times, std::span<const Quat> values, Ends ends,
                         std::span<Vec3> out) {
    squad_velocities(times, values, 0, ends, out);
  }
  static Quat smooth(const Quat& q0, const Vec3& w0, const Quat& q1, const Vec3& w1, double span,
                     double t) {
    return squad(q0, w0, q1, w1, span, t);
  }
  static Quat straight(const Quat& from, const Quat& to, double t) { return slerp(from, to, t); }
};

Error wrong(std::size_t key, const std::string& what) {
  return Error("camera-keys", fmt::format("key {}: {}", key, what));
}

Status check_direction(std::size_t index, const CameraKey& key) {
  if (key.target.has_value() == key.orientation.has_value()) {
    return wrong(index, "expected exactly one of target and orientation");
  }
  if (key.target) {
    if (!key.target->allFinite()) return wrong(index, "the target is not finite");
    if ((*key.target - key.position).norm() < 1e-6) {
      return wrong(index, "the target is at the camera's position");
    }
    return {};
  }
  const bool unit = std::abs(key.orientation->norm() - 1) < 1e-3;  // false for NaN
  return unit ? Status() : wrong(index, "the orientation is not a unit quaternion");
}

Status check_key(std::size_t index, const CameraKey& key) {
  if (!(key.time >= 0) || !std::isfinite(key.time)) {
    return wrong(index, fmt::format("the time is {} s, expected at least 0", readable(key.time)));
  }
  if (!key.position.allFinite() || !std::isfinite(key.roll)) {
    return wrong(index, "position or roll is not finite");
  }
  if (!(key.tension >= 0 && key.tension <= 1)) {
    return wrong(index, fmt::format("the tension is {}, expected 0 to 1", readable(key.tension)));
  }
  if (key.field_of_view && !(*key.field_of_view > 0 && *key.field_of_view < kPi)) {
    return wrong(index, "the field of view is not between 0 and 180 degrees");
  }
  return check_direction(index, key);
}

Status check(const KeyedCamera& camera) {
  if (camera.keys.empty()) return Error("camera-keys", "there are no keys");
  for (std::size_t i = 0; i < camera.keys.size(); ++i) {
    const CameraKey& key = camera.keys[i];
    if (Status status = check_key(i, key); !status) return status;
    if (i > 0 && !(key.time > camera.keys[i - 1].time)) {
      return wrong(i, fmt::format("the time, {} s, is not after that of the previous key",
                                  readable(key.time)));
    }
    if (camera.closed && i + 1 < camera.keys.size() && key.between != Between::smooth) {
      return wrong(i, "all keys of a closed camera must be smooth");
    }
  }
  return {};
}

// The keys that define a property.
template <typename Wanted>
KeyTimes times_of(const KeyedCamera& camera, const Wanted& wanted) {
  KeyTimes keys;
  for (const CameraKey& key : camera.keys) {
    if (!wanted(key)) continue;
    keys.times.push_back(key.time);
    keys.between.push_back(key.between);
    keys.tensions.push_back(key.tension);
  }
  // A property is closed only if its first and last key are those of the camera.
  keys.closed = camera.closed && keys.times.size() > 1 &&
                keys.times.front() == camera.keys.front().time &&
                keys.times.back() == camera.keys.back().time;
  return keys;
}

KeyTimes times_of(const KeyedCamera& camera) {
  return times_of(camera, [](const CameraKey&) { return true; });
}

template <typename Value, typename Get>
std::vector<Value> values_of(const KeyedCamera& camera, const Get& get) {
  std::vector<Value> values;
  for (const CameraKey& key : camera.keys) values.push_back(get(key));
  return values;
}

// The time whose view is shown: that of the key before where it holds until the next.
double held(const KeyedCamera& camera, double time) {
  const auto after = std::ranges::upper_bound(camera.keys, time, {}, &CameraKey::time);
  if (after == camera.keys.begin() || after == camera.keys.end()) return time;
  const CameraKey& before = *std::prev(after);
  return before.between == Between::step ? before.time : time;
}

// The first frames at or after the keys that a step leads to.
std::vector<int> cuts_of(const KeyedCamera& camera, std::span<const double> moments) {
  std::vector<int> cuts;
  for (std::size_t key = 1; key < camera.keys.size(); ++key) {
    if (camera.keys[key - 1].between != Between::step) continue;
    const auto frame = std::ranges::lower_bound(moments, camera.keys[key].time) - moments.begin();
    const int cut = static_cast<int>(std::min(frame, std::ssize(moments) - 1));
    if (cut > 0 && (cuts.empty() || cuts.back() < cut)) cuts.push_back(cut);
  }
  return cuts;
}

std::vector<double> lens_over_time(const KeyedCamera& camera, std::span<const double> moments) {
  KeyTimes keys =
      times_of(camera, [](const CameraKey& key) { return key.field_of_view.has_value(); });
  std::vector<double> lens(moments.size(), kUsualFieldOfView);
  if (keys.times.empty()) return lens;
  std::vector<double> values;
  for (const CameraKey& key : camera.keys) {
    if (key.field_of_view) values.push_back(*key.field_of_view);
  }
  const KeyedCurve<MonotoneNumber> curve(std::move(keys), std::move(values));
  std::ranges::transform(moments, lens.begin(),
                         [&](double time) { return curve.at(held(camera, time)); });
  return lens;
}

// View directions, without the roll.
std::vector<Quat> directions_over_time(const KeyedCamera& camera, std::span<const double> moments,
                                       std::span<const Vec3> positions) {
  std::vector<Vec3> targets;
  const bool all_aimed =
      std::ranges::all_of(camera.keys, [](const CameraKey& key) { return key.target.has_value(); });
  if (all_aimed) {
    const KeyedCurve<Point> curve(
        times_of(camera),
        values_of<Vec3>(camera, [](const CameraKey& key) { return *key.target; }));
    for (const double time : moments) targets.push_back(curve.at(time));
    return look_at(positions, targets);
  }
  // Where keys with a target and keys with an orientation are mixed, each target is evaluated at
  // its own key.
  std::vector<Quat> at_keys;
  Quat before = Quat::Identity();
  for (const CameraKey& key : camera.keys) {
    before = key.orientation ? key.orientation->normalized()
                             : look_at(key.position, *key.target, before);
    at_keys.push_back(before);
  }
  const KeyedCurve<Rotation> curve(times_of(camera), std::move(at_keys));
  std::vector<Quat> directions;
  for (const double time : moments) directions.push_back(curve.at(time));
  return directions;
}

// The times of the frames; the last is not before `end`, within a millionth of a frame.
Result<std::vector<double>> frame_times(double end, double rate) {
  if (Status status = check_frame_rate(rate, "camera-rate"); !status) return status.error();
  const double last = std::ceil(end * rate - 1e-6);
  if (!(last < kMaxFrames)) {
    return Error("camera-too-long",
                 fmt::format("{} s at {} fps exceed the limit of 10 million frames", readable(end),
                             readable(rate)));
  }
  std::vector<double> times;
  for (int i = 0; i <= static_cast<int>(last); ++i) times.push_back(i / rate);
  return times;
}

}  // namespace

Result<CameraTrack> make_track(const KeyedCamera& camera, double rate) {
  if (Status status = check(camera); !status) return status.error();
  const auto moments = frame_times(camera.keys.back().time, rate);
  if (!moments) return moments.error();

  const KeyedCurve<Point> places(
      times_of(camera), values_of<Vec3>(camera, [](const CameraKey& key) { return key.position; }));
  std::vector<Vec3> positions;
  for (const double time : *moments) positions.push_back(places.at(time));
  const std::vector<Quat> directions = directions_over_time(camera, *moments, positions);
  const KeyedCurve<Number> rolls(
      times_of(camera), values_of<double>(camera, [](const CameraKey& key) { return key.roll; }));
  const std::vector<double> lens = lens_over_time(camera, *moments);

  CameraTrack track;
  track.rate = rate;
  track.cuts = cuts_of(camera, *moments);
  for (std::size_t i = 0; i < moments->size(); ++i) {
    const Quat turned = rolled(directions[i], rolls.at((*moments)[i]));
    track.positions.push_back(positions[i].cast<float>());
    track.orientations.push_back(turned.cast<float>().normalized());
    track.fields_of_view.push_back(static_cast<float>(lens[i]));
  }
  if (Status status = krok::check(track); !status) {
    return Error("camera-keys", "the interpolated values are not finite",
                 "check positions and tensions");
  }
  return track;
}

}  // namespace krok
