#include "filter/spikes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "math/quaternion.h"

namespace krok::filter {

namespace {

Vec3 difference(const Vec3& from, const Vec3& to) {
  return to - from;
}
Vec3 difference(const Quat& from, const Quat& to) {
  return rotation_vector(from.conjugate() * to);
}
Vec3 moved(const Vec3& from, const Vec3& by) {
  return from + by;
}
Quat moved(const Quat& from, const Vec3& by) {
  return from * from_rotation_vector(by);
}

constexpr int kPair = 3;  // frames of two spikes with one valid frame between them

struct Run {
  int first, last;
  double size;
};

// One joint's rotations or positions over time.
template <typename Value>
class SpikeFinder {
 public:
  SpikeFinder(std::span<Value> series, double threshold, double least, int longest, int around)
      : series_(series),
        shown_(series),
        count_(static_cast<int>(series.size())),
        threshold_(threshold),
        least_(least),
        longest_(longest),
        around_(around) {}

  // Replaces spikes in the series, short ones first: a short one may look like part of a longer
  // one.
  std::vector<Run> remove() {
    std::vector<Run> runs;
    if (count_ < 5) return runs;
    for (int f = 0; f < count_; ++f) deviations_.push_back(deviation(f, 1));
    for (int length = 1; length <= std::min(std::max(longest_, kPair), count_ - 4); ++length) {
      forget_limits(length);
      for (int first = 0; first + length <= count_; ++first) {
        const Run run{first, first + length - 1, 0};
        if (!suspicious(first) || !is_spike(run)) continue;
        runs.push_back(replace(run));
        for (int f = std::max(0, run.first - 2); f <= std::min(count_ - 1, run.last + 2); ++f) {
          deviations_[at(f)] = deviation(f, 1);
        }
      }
    }
    std::ranges::sort(runs, {}, &Run::first);
    return runs;
  }

  // The largest distance of the run from the cubic through its neighbours.
  double stray(const Run& run) const {
    double largest = 0;
    for (int f = run.first; f <= run.last; ++f) {
      largest = std::max(largest, difference(guess(f, support(f, run)), value(f)).norm());
    }
    return largest;
  }

  // Replaces the run by that cubic; returns it with its size.
  Run replace(Run run) {
    run.size = stray(run);
    std::vector<Value> better;
    for (int f = run.first; f <= run.last; ++f) better.push_back(guess(f, support(f, run)));
    std::ranges::copy(better, series_.begin() + run.first);
    return run;
  }

 private:
  static std::size_t at(int frame) { return static_cast<std::size_t>(frame); }
  const Value& value(int frame) const { return shown_[at(frame)]; }

  // The frames from which the value at `frame` is predicted without those of `run`: up to two on
  // each side, so two in total if one side has none.
  struct Support {
    std::array<int, 4> frames{};
    int count = 0;
    bool both_sides = false;
  };
  Support support(int frame, const Run& run) const {
    Support found;
    const auto walk = [&](int step) {
      int taken = 0;
      for (int f = frame + step; taken < 2 && f >= 0 && f < count_; f += step) {
        if (f >= run.first && f <= run.last) continue;
        found.frames[at(found.count++)] = f;
        ++taken;
      }
      return taken;
    };
    const int before = walk(-1), after = walk(1);
    found.both_sides = before > 0 && after > 0;
    return found;
  }

  // Lagrange polynomial through the support, in the tangent space of its first frame.
  Value guess(int frame, const Support& support) const {
    const Value& base = value(support.frames[0]);
    Vec3 sum = Vec3::Zero();
    for (int i = 1; i < support.count; ++i) {
      double weight = 1;
      for (int k = 0; k < support.count; ++k) {
        if (k == i) continue;
        weight *= static_cast<double>(frame - support.frames[at(k)]) /
                  (support.frames[at(i)] - support.frames[at(k)]);
      }
      sum += weight * difference(base, value(support.frames[at(i)]));
    }
    return moved(base, sum);
  }

  // Distance of the frame from the prediction, divided by the limit; over 1 exceeds it.
  double excess(int frame, const Run& run) {
    const Support from = support(frame, run);
    if (from.count < 2) return 0;
    const double distance = difference(guess(frame, from), value(frame)).norm();
    return distance / (from.both_sides ? limit(frame) : 2 * limit(frame));
  }

  // Distance of the first frame of a run from its prediction without the run.
  double deviation(int frame, int length) const {
    const Run run{frame, std::min(count_, frame + length) - 1, 0};
    return difference(guess(frame, support(frame, run)), value(frame)).norm();
  }

  // The usual deviation depends on the length of the gap that is predicted across. Limits are those
  // of the series as it is now, and computed where they are needed: in few frames of most motions.
  void forget_limits(int length) {
    length_ = length;
    before_.assign(series_.begin(), series_.end());
    if (length == 1) usual_ = deviations_;
    if (length > 1) usual_.assign(at(count_), kUnknown);
    limits_.assign(at(count_), kUnknown);
    near_.clear();
  }

  double usual(int frame) {
    double& known = usual_[at(frame)];
    if (known < 0) {
      shown_ = before_;
      known = deviation(frame, length_);
      shown_ = series_;
    }
    return known;
  }

  double limit(int frame) {
    double& known = limits_[at(frame)];
    if (known < 0) {
      move_to(frame);
      known = std::max(least_, threshold_ * near_[near_.size() / 2]);
    }
    return known;
  }

  void move_to(int frame) {
    const auto place = [&](double value) { return std::ranges::lower_bound(near_, value); };
    if (near_.empty() || frame < centre_ || frame > centre_ + around_) {
      near_.clear();
      centre_ = frame;
      for (int f = std::max(0, frame - around_); f <= std::min(count_ - 1, frame + around_); ++f) {
        near_.push_back(usual(f));
      }
      std::ranges::sort(near_);
    }
    while (centre_ < frame) {
      ++centre_;
      const int in = centre_ + around_, out = in - 2 * around_ - 1;
      if (in < count_) near_.insert(place(usual(in)), usual(in));
      if (out >= 0) near_.erase(place(usual(out)));
    }
  }

  // A jump between a frame and the previous one raises the deviation of at least one of them.
  bool suspicious(int frame) {
    const auto shows = [&](int f) {
      return f >= 0 && f < count_ && deviations_[at(f)] > 0.2 * least_ &&
             deviations_[at(f)] > 0.2 * limit(f);
    };
    return shows(frame) || shows(frame - 1);
  }

  bool is_spike(const Run& run) {
    if (excess(run.first, run) <= 1 || excess(run.last, run) <= 1) return false;
    const int before = run.first - 1, after = run.last + 1;
    if (before < 0 || after >= count_) return run.first == run.last && jumps_at_end(run.first);
    if (!is_abrupt(run)) return false;
    // Two spikes with a valid frame between them look like a longer one.
    for (int f = run.first + 1; f < run.last && run.last - run.first >= longest_; ++f) {
      if (excess(f, run) > 1) return false;
    }
    // The frames next to a spike must be valid without it.
    return excess(before, run) <= 1 && excess(after, run) <= 1;
  }

  // Whether the steps into and out of the run are large compared to the steps just before and
  // after, and to the distance across the run. A fast gesture accelerates; a spike does not.
  bool is_abrupt(const Run& run) const {
    const auto step = [&](int from, int to) {
      return from < 0 || to >= count_ ? 0 : difference(value(from), value(to)).norm();
    };
    const int before = run.first - 1, after = run.last + 1;
    const double calm = std::max(
        {2 * step(before - 1, before), 2 * step(after, after + 1), 0.5 * step(before, after)});
    return step(before, run.first) > calm && step(run.last, after) > calm;
  }

  // Whether the clip's first or last frame is separated by a step many times larger than those next
  // to it.
  bool jumps_at_end(int frame) const {
    const int inwards = frame == 0 ? 1 : -1;
    const auto step = [&](int k) {
      return difference(value(frame + k * inwards), value(frame + (k + 1) * inwards)).norm();
    };
    return step(0) > threshold_ * std::max({step(1), step(2), step(3), least_ / threshold_});
  }

  static constexpr double kUnknown = -1;

  std::span<Value> series_;
  std::span<const Value> shown_;  // what value() reads: the series, or before_
  int count_;
  double threshold_, least_;
  int longest_, around_;
  std::vector<double> deviations_;
  // Of runs of length_ frames, of the series before any of them was replaced.
  int length_ = 1;
  std::vector<Value> before_;
  std::vector<double> usual_, limits_;
  std::vector<double> near_;  // sorted: the usual deviations within around_ of centre_
  int centre_ = 0;
};

Status check(const SpikeOptions& options) {
  for (const double value :
       {options.threshold, options.least_angle, options.least_distance, options.longest}) {
    if (!(value > 0) || !std::isfinite(value)) {
      return Error("filter-threshold", "spike thresholds must be positive and finite");
    }
  }
  return {};
}

struct Lengths {
  int longest, around;  // frames
};

Lengths lengths_of(const SpikeOptions& options, double rate) {
  const auto frames_of = [&](double seconds, double most) {
    return static_cast<int>(std::min(most, std::round(seconds * rate)));
  };
  return {std::max(1, frames_of(options.longest, 32)), std::max(10, frames_of(0.5, 256))};
}

// How far a joint is from the way through its places before and after some frames.
double strays(const Clip& clip, std::size_t joint, const Run& run) {
  const int first = std::max(0, run.first - 2);
  std::vector<Vec3> places;
  for (int f = first; f <= std::min(clip.frame_count() - 1, run.last + 2); ++f) {
    places.push_back(clip.frame_positions(f)[joint].cast<double>());
  }
  return SpikeFinder<Vec3>(places, 0, 0, 0, 0).stray({run.first - first, run.last - first, 0});
}

constexpr double kNoJump = 0.1 * kRadiansPerDegree;  // not worth a mention

// A fit to markers may turn a joint one way and its children back, so that hands and feet stay
// where they are: to replace the joint alone throws them aside. What is between is replaced, too;
// where they are thrown even so, nothing is.
class ThrowRepair {
 public:
  ThrowRepair(const Clip& before, double most, std::span<const std::uint8_t> joints,
              LocalMotion& motion, const std::vector<Spike>& spikes)
      : before_(before),
        most_(most),
        joints_(joints),
        given_(local_motion(before)),
        motion_(motion),
        after_(before) {
    for (const Spike& spike : spikes) replaced_.push_back({spike, replaced_.size()});
  }

  SpikeRemoval repair() {
    set_local_motion(motion_, after_);
    bool changed = false;
    for (std::size_t i = replaced_.size(); i-- > 0;) changed = extend(i) || changed;
    // What one replacement made up for, another may have relied on.
    while (changed) {
      set_local_motion(motion_, after_);
      changed = take_back();
    }
    SpikeRemoval result{std::move(after_), {}};
    for (const Replaced& one : replaced_) {
      if (!one.taken_back) result.spikes.push_back(one.spike);
    }
    sort_spikes(result.spikes);
    return result;
  }

 private:
  struct Replaced {
    Spike spike;
    std::size_t cause;  // index of the spike for whose sake
    bool taken_back = false;
  };

  static std::size_t at(int joint) { return static_cast<std::size_t>(joint); }
  static Run run_of(const Spike& spike) { return {spike.first_frame, spike.last_frame, 0}; }

  // The joints below that of a spike which are further off their way than before.
  std::vector<int> thrown(const Spike& spike) const {
    const auto& parents = before_.skeleton.parents;
    std::vector<std::uint8_t> below(parents.size(), 0);
    below[at(spike.joint)] = 1;
    std::vector<int> found;
    for (std::size_t j = at(spike.joint) + 1; j < parents.size(); ++j) {
      below[j] = below[at(parents[j])];
      if (below[j] == 0) continue;
      const double more = strays(after_, j, run_of(spike)) - strays(before_, j, run_of(spike));
      if (more > most_) found.push_back(static_cast<int>(j));
    }
    return found;
  }

  // Replaces the joints between that of a spike and those that it throws.
  bool extend(std::size_t cause) {
    const Spike spike = replaced_[cause].spike;
    const std::vector<int> ends = thrown(spike);
    if (ends.empty()) return false;
    const auto& parents = before_.skeleton.parents;
    std::vector<std::uint8_t> done(parents.size(), 0);
    for (const auto& [other, of, taken_back] : replaced_) {
      if (!other.of_position && other.first_frame <= spike.first_frame &&
          other.last_frame >= spike.last_frame) {
        done[at(other.joint)] = 1;
      }
    }
    for (const int end : ends) {
      for (int j = parents[at(end)]; j > spike.joint; j = parents[at(j)]) {
        if (std::exchange(done[at(j)], 1) != 0) continue;
        if (!joints_.empty() && joints_[at(j)] == 0) continue;
        SpikeFinder<Quat> series(motion_.joint_orientations(j), 0, 0, 0, 0);
        if (series.stray(run_of(spike)) < kNoJump) continue;
        const double size = series.replace(run_of(spike)).size;
        replaced_.push_back({{j, spike.first_frame, spike.last_frame, false, size}, cause});
      }
    }
    return true;
  }

  // Takes back what still throws, and what was replaced for its sake.
  bool take_back() {
    std::vector<std::uint8_t> back(replaced_.size(), 0);
    for (const auto& [spike, cause, taken_back] : replaced_) {
      if (!taken_back && back[cause] == 0 && !thrown(spike).empty()) back[cause] = 1;
    }
    bool any = false;
    for (auto& [spike, cause, taken_back] : replaced_) {
      if (taken_back || back[cause] == 0) continue;
      any = taken_back = true;
      for (int f = spike.first_frame; f <= spike.last_frame; ++f) {
        Transform local = motion_.at(spike.joint, f);
        const Transform given = given_.at(spike.joint, f);
        if (spike.of_position) local.position = given.position;
        if (!spike.of_position) local.orientation = given.orientation;
        motion_.set(spike.joint, f, local);
      }
    }
    return any;
  }

  const Clip& before_;
  double most_;  // metres
  std::span<const std::uint8_t> joints_;
  const LocalMotion given_;
  LocalMotion& motion_;
  Clip after_;
  std::vector<Replaced> replaced_;
};

}  // namespace

void sort_spikes(std::vector<Spike>& spikes) {
  std::ranges::stable_sort(spikes, {}, [](const Spike& spike) {
    return std::tuple(spike.joint, spike.of_position, spike.first_frame);
  });
}

SpikeRemoval without_throws(const Clip& before, double most, std::span<const std::uint8_t> joints,
                            LocalMotion& motion, const std::vector<Spike>& spikes) {
  return ThrowRepair(before, most, joints, motion, spikes).repair();
}

namespace {

// `moving`: as of moving_joints(), of the whole motion; empty: of this clip.
SpikeRemoval without_spikes(const Clip& clip, const SpikeOptions& options,
                            std::span<const std::uint8_t> joints, std::vector<std::uint8_t> moving,
                            int jobs) {
  LocalMotion motion = local_motion(clip);
  if (moving.empty()) moving = moving_joints(motion);
  const Lengths lengths = lengths_of(options, clip.rate);

  std::vector<std::vector<Spike>> found(clip.skeleton.names.size());
  parallel_for(found.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      if (!joints.empty() && joints[j] == 0) continue;
      const int joint = static_cast<int>(j);
      const auto note = [&](const std::vector<Run>& runs, bool of_position) {
        for (const Run& run : runs) {
          found[j].push_back({joint, run.first, run.last, of_position, run.size});
        }
      };
      note(SpikeFinder<Quat>(motion.joint_orientations(joint), options.threshold,
                             options.least_angle, lengths.longest, lengths.around)
               .remove(),
           false);
      if (moving[j] == 0) continue;
      note(SpikeFinder<Vec3>(motion.joint_positions(joint), options.threshold,
                             options.least_distance, lengths.longest, lengths.around)
               .remove(),
           true);
    }
  });

  std::vector<Spike> spikes;
  for (const auto& of_joint : found) spikes.insert(spikes.end(), of_joint.begin(), of_joint.end());
  if (spikes.empty()) return {clip, {}};
  return without_throws(clip, 0.5 * options.least_distance, joints, motion, spikes);
}

}  // namespace

Result<SpikeRemoval> remove_spikes(const Clip& clip, const SpikeOptions& options,
                                   std::span<const std::uint8_t> joints, int jobs) {
  if (Status status = check(options); !status) return status.error();
  return without_spikes(clip, options, joints, {}, jobs);
}

Result<FrameSource> remove_spikes(
    const FrameSource& source, const SpikeOptions& options, std::span<const std::uint8_t> joints,
    int jobs, const std::function<void(const FrameRun& before, const SpikeRemoval& after)>& watch,
    int block_frames) {
  if (Status status = check(options); !status) return status.error();
  auto moving = moving_joints(source, jobs);
  if (!moving) return moving.error();
  // A limit is of frames around it, in which shorter spikes were replaced by limits of their own.
  const auto [longest, around] = lengths_of(options, source.rate);
  const int reach = std::max(longest, kPair) * (around + longest + 8);
  return changed_in_blocks(
      source, {block_frames, reach}, jobs,
      [moving = *std::move(moving), options, jobs, watch,
       joints = std::vector(joints.begin(), joints.end())](FrameRun& run) {
        SpikeRemoval removal = without_spikes(run.clip, options, joints, moving, jobs);
        std::erase_if(removal.spikes, [&](const Spike& spike) {
          return spike.first_frame < run.kept_begin || spike.first_frame >= run.kept_end;
        });
        for (Spike& spike : removal.spikes) {
          spike.first_frame += run.first;
          spike.last_frame += run.first;
        }
        if (watch) watch(run, removal);
        run.clip = std::move(removal.clip);
        return Status();
      });
}

}  // namespace krok::filter
