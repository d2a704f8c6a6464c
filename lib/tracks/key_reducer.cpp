#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "math/quaternion.h"
#include "scene/skeleton.h"
#include "tracks/key_reducer_internal.h"

namespace krok::tracks_detail {

namespace {

// All frames start as keys, and keys are removed one by one while the joint's descendants stay
// within the tolerance: first every second key, then every second of the remaining ones, and so on.
// All that is done with fractions of the tolerance first, so that no track uses up what others
// could share.
constexpr std::array<double, 5> kParts = {0.125, 0.25, 0.5, 0.75, 1.0};

// Then pairs of keys are merged into one where possible, which removes up to a tenth. A top-down
// search that inserts keys where the error is largest finds about as few in thirty times the time.
constexpr int kMergePasses = 2;

// Of the tolerance, what tracks without keys may take: in a file each has about 180 bytes of JSON.
constexpr double kRestPart = 0.6;

class Reducer {
 public:
  Reducer(const ReductionTask& task, std::size_t begin, std::size_t end)
      : task_(task),
        begin_(begin),
        frames_(end - begin),
        joints_(task.parents.size()),
        tracks_(kTracksPerJoint * joints_),
        world_(frames_ * joints_),
        reduced_(frames_ * joints_),
        reduced_world_(frames_ * joints_),
        is_key_(tracks_ * frames_) {
    for (std::size_t track = 0; track < tracks_; ++track) {
      std::fill_n(is_key_.begin() + static_cast<std::ptrdiff_t>(track * frames_), frames_,
                  task.keep[track] <= Keep::first ? 0 : 1);
    }
    for (std::size_t f = 0; f < frames_; ++f) {
      local_to_world(task.parents, task.local.subspan((begin_ + f) * joints_, joints_),
                     std::span(world_).subspan(f * joints_, joints_));
      for (std::size_t joint = 0; joint < joints_; ++joint) {
        const Transform& now = original(f, joint);
        const std::size_t track = kTracksPerJoint * joint;
        const auto shown = [&](std::size_t t) -> const Transform& {
          return task.keep[t] <= Keep::first ? task.constant(t) : now;
        };
        reduced_[f * joints_ + joint] = {shown(track).position, shown(track + 1).orientation};
        place(f, joint);
      }
    }
  }

  void take_keys_out() {
    for (const double part : kParts) {
      tolerance_ = part * task_.options.tolerance;
      for (std::size_t step = 1; step < frames_; step *= 2) {
        for (std::size_t f = step; f + 1 < frames_; f += 2 * step) take_out_at(f);
      }
    }
    for (std::size_t f = 1; f + 1 < frames_; ++f) take_out_at(f);
    for (int pass = 0; pass < kMergePasses; ++pass) merge_keys();
  }

  // The tracks that need keys, but can do without: at rest, together, within a part of the
  // tolerance. Those whose loss is seen least go first.
  std::vector<std::size_t> tracks_to_rest() {
    std::vector<std::pair<double, std::size_t>> candidates;
    tolerance_ = kRestPart * task_.options.tolerance;
    for (std::size_t track = 0; track < tracks_; ++track) {
      if (task_.keep[track] != Keep::needed) continue;
      const double worst = put_to_rest(track);
      if (worst <= tolerance_) candidates.emplace_back(worst, track);
      put_back(track);
    }
    std::ranges::sort(candidates);
    std::vector<std::size_t> rested;
    for (const auto& [worst, track] : candidates) {
      if (put_to_rest(track) <= tolerance_) {
        rested.push_back(track);
      } else {
        put_back(track);
      }
    }
    return rested;
  }

  StretchResult result() const;

 private:
  double put_to_rest(std::size_t track);
  void put_back(std::size_t track);
  const Transform& original(std::size_t f, std::size_t joint) const {
    return task_.local[(begin_ + f) * joints_ + joint];
  }
  double time(std::size_t f) const { return task_.times[begin_ + f]; }
  bool is_key(std::size_t track, std::size_t f) const { return is_key_[track * frames_ + f] != 0; }

  // Leaf joints first: they move the least.
  void take_out_at(std::size_t f) {
    for (std::size_t track = tracks_; track-- > 0;) {
      if (task_.keep[track] == Keep::needed && is_key(track, f)) take_out(track, f);
    }
  }

  void take_out(std::size_t track, std::size_t f);
  void merge_keys();
  std::optional<std::size_t> merged(std::size_t track, std::size_t f, std::size_t g);
  bool one_key_fits(std::size_t track, std::size_t a, std::size_t b, std::size_t key);
  void set_segments(std::size_t track, std::size_t a, std::size_t b);
  std::size_t neighbour(std::size_t track, std::size_t f, int step) const;
  void interpolate(std::size_t track, std::size_t a, std::size_t b, std::size_t f);
  void set_original(std::size_t track, std::size_t f);
  void place(std::size_t f, std::size_t joint);
  double error(std::size_t f, std::size_t joint) const;
  bool fits(std::size_t f, std::size_t joint);

  const ReductionTask& task_;
  std::size_t begin_, frames_, joints_, tracks_;
  std::vector<Transform> world_;                    // original motion, [frames x joints]
  std::vector<Transform> reduced_, reduced_world_;  // motion given by the keys
  std::vector<std::uint8_t> is_key_;                // [tracks x frames]
  double tolerance_ = 0;
};

// Without keys in all frames, or up to the first that is beyond the tolerance; the largest error.
double Reducer::put_to_rest(std::size_t track) {
  const std::size_t joint = track / kTracksPerJoint;
  const Transform& rest = task_.options.rest[joint];
  double worst = 0;
  for (std::size_t f = 0; f < frames_ && worst <= tolerance_; ++f) {
    Transform& out = reduced_[f * joints_ + joint];
    if (track % kTracksPerJoint == 0) {
      out.position = rest.position;
    } else {
      out.orientation = rest.orientation;
    }
    for (const int below : task_.below[joint]) {
      place(f, static_cast<std::size_t>(below));
      worst = std::max(worst, error(f, static_cast<std::size_t>(below)));
    }
  }
  return worst;
}

void Reducer::put_back(std::size_t track) {
  for (std::size_t f = 0; f < frames_; ++f) {
    set_original(track, f);
    for (const int below : task_.below[track / kTracksPerJoint]) {
      place(f, static_cast<std::size_t>(below));
    }
  }
}

// The next key after or before a frame; it must exist.
std::size_t Reducer::neighbour(std::size_t track, std::size_t f, int step) const {
  do {
    f = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(f) + step);
  } while (!is_key(track, f));
  return f;
}

// Interpolates a track at frame f between the keys a and b.
void Reducer::interpolate(std::size_t track, std::size_t a, std::size_t b, std::size_t f) {
  const std::size_t joint = track / kTracksPerJoint;
  const Transform& from = original(a, joint);
  const Transform& to = original(b, joint);
  const double part = (time(f) - time(a)) / (time(b) - time(a));
  Transform& out = reduced_[f * joints_ + joint];
  if (track % kTracksPerJoint == 0) {
    out.position = from.position + part * (to.position - from.position);
  } else {
    out.orientation = slerp(from.orientation, to.orientation, part);
  }
}

void Reducer::set_original(std::size_t track, std::size_t f) {
  const std::size_t joint = track / kTracksPerJoint;
  Transform& out = reduced_[f * joints_ + joint];
  if (track % kTracksPerJoint == 0) {
    out.position = original(f, joint).position;
  } else {
    out.orientation = original(f, joint).orientation;
  }
}

void Reducer::place(std::size_t f, std::size_t joint) {
  const std::size_t row = f * joints_;
  const Transform& local = reduced_[row + joint];
  const int parent = task_.parents[joint];
  reduced_world_[row + joint] =
      parent < 0 ? local : reduced_world_[row + static_cast<std::size_t>(parent)] * local;
}

double Reducer::error(std::size_t f, std::size_t joint) const {
  const std::size_t at = f * joints_ + joint;
  return shell_error(world_[at], reduced_world_[at], task_.shell_of(joint));
}

// Updates the joint's descendants at a frame, up to the first whose error exceeds the tolerance.
bool Reducer::fits(std::size_t f, std::size_t joint) {
  return std::ranges::all_of(task_.below[joint], [&](int below) {
    const auto j = static_cast<std::size_t>(below);
    place(f, j);
    return error(f, j) <= tolerance_;
  });
}

// Removes a key if the tolerance allows it; otherwise restores the previous state.
void Reducer::take_out(std::size_t track, std::size_t f) {
  const std::size_t joint = track / kTracksPerJoint;
  const std::size_t a = neighbour(track, f, -1), b = neighbour(track, f, 1);
  const auto fits_at = [&](std::size_t g) {
    interpolate(track, a, b, g);
    return fits(g, joint);
  };
  // From the key outwards: most removals that fail do so near it.
  std::size_t low = f, high = f;
  bool fine = fits_at(f);
  while (fine && (low > a + 1 || high + 1 < b)) {
    if (low > a + 1) fine = fits_at(--low);
    if (fine && high + 1 < b) fine = fits_at(++high);
  }
  if (fine) {
    is_key_[track * frames_ + f] = 0;
    return;
  }
  for (std::size_t g = low; g <= high; ++g) {
    if (g == f) {
      set_original(track, g);
    } else {
      interpolate(track, g < f ? a : f, g < f ? f : b, g);
    }
    for (const int below : task_.below[joint]) place(g, static_cast<std::size_t>(below));
  }
}

// Re-evaluates a track between frames a and b from the keys between them.
void Reducer::set_segments(std::size_t track, std::size_t a, std::size_t b) {
  const std::size_t joint = track / kTracksPerJoint;
  for (std::size_t from = a; from < b;) {
    const std::size_t to = neighbour(track, from, 1);
    for (std::size_t f = from + 1; f <= to && f < b; ++f) {
      if (f == to) {
        set_original(track, f);
      } else {
        interpolate(track, from, to, f);
      }
      for (const int below : task_.below[joint]) place(f, static_cast<std::size_t>(below));
    }
    from = to;
  }
}

// Whether one key is enough between two others; leaves the frames that were tried changed.
bool Reducer::one_key_fits(std::size_t track, std::size_t a, std::size_t b, std::size_t key) {
  const std::size_t joint = track / kTracksPerJoint;
  const auto fits_at = [&](std::size_t f) {
    if (f == key) {
      set_original(track, f);
    } else {
      interpolate(track, f < key ? a : key, f < key ? key : b, f);
    }
    return fits(f, joint);
  };
  // The middles of both segments first: they fail soonest.
  const std::size_t before = (a + key + 1) / 2, after = (key + b) / 2;
  if (!fits_at(before) || !fits_at(after)) return false;
  for (std::size_t f = a + 1; f < b; ++f) {
    if (f != before && f != after && !fits_at(f)) return false;
  }
  return true;
}

// Replaces two neighbouring keys by one, at one of several frames between them, if the tolerance
// allows it. Returns it, or nullopt after restoring the previous state.
std::optional<std::size_t> Reducer::merged(std::size_t track, std::size_t f, std::size_t g) {
  const std::size_t a = neighbour(track, f, -1), b = neighbour(track, g, 1);
  constexpr std::size_t kMaxPlaces = 9;
  const std::size_t places = std::min(g - f + 1, kMaxPlaces);
  std::uint8_t* keys = is_key_.data() + track * frames_;
  for (std::size_t i = 0; i < places; ++i) {
    const std::size_t place = (i + places / 2) % places;  // starting from the middle
    const std::size_t key = f + (g - f) * place / (places - 1);
    if (!one_key_fits(track, a, b, key)) continue;
    keys[f] = keys[g] = 0;
    keys[key] = 1;
    return key;
  }
  set_segments(track, a, b);
  return {};
}

void Reducer::merge_keys() {
  for (std::size_t track = tracks_; track-- > 0;) {
    if (task_.keep[track] != Keep::needed) continue;
    const std::size_t last = frames_ - 1;
    std::size_t f = neighbour(track, 0, 1);
    while (f < last) {
      const std::size_t g = neighbour(track, f, 1);
      if (g == last) break;
      f = merged(track, f, g).value_or(g);
    }
  }
}

StretchResult Reducer::result() const {
  StretchResult result;
  result.keys.resize(tracks_);
  for (std::size_t track = 0; track < tracks_; ++track) {
    for (std::size_t f = 0; f < frames_; ++f) {
      if (is_key(track, f)) result.keys[track].push_back(static_cast<int>(begin_ + f));
    }
  }
  for (std::size_t f = 0; f < frames_; ++f) {
    for (std::size_t j = 0; j < joints_; ++j) {
      const double off = error(f, j);
      if (!(off > result.largest_error)) continue;  // NaN too
      result.largest_error = off;
      result.worst_joint = static_cast<int>(j);
      result.worst_frame = static_cast<int>(begin_ + f);
    }
  }
  return result;
}

}  // namespace

double rotation_error(const Quat& original, const Quat& reduced, double reach) {
  // A point at a distance r from the axis moves by 2 r sin(angle / 2).
  return 2 * reach * (original.conjugate() * reduced).vec().norm();
}

double shell_error(const Transform& original, const Transform& reduced, double shell_distance) {
  return (original.position - reduced.position).norm() +
         rotation_error(original.orientation, reduced.orientation, shell_distance);
}

void put_to_rest(ReductionTask& task) {
  for (const std::size_t track : Reducer(task, 0, task.times.size()).tracks_to_rest()) {
    task.keep[track] = Keep::rest;
  }
}

StretchResult reduce_stretch(const ReductionTask& task, std::size_t begin, std::size_t end) {
  Reducer reducer(task, begin, end);
  reducer.take_keys_out();
  return reducer.result();
}

}  // namespace krok::tracks_detail
