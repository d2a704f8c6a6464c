#include "character/sampling.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "character/motion.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "math/quaternion.h"

namespace krok::character {

namespace {

constexpr std::array kCommonRates = {30.0,         24.0,         25.0,          60.0,
                                     50.0,         48.0,         120.0,         100.0,
                                     90.0,         240.0,        30.0 / 1.001,  24.0 / 1.001,
                                     60.0 / 1.001, 48.0 / 1.001, 120.0 / 1.001, 240.0 / 1.001};
constexpr double kMinRate = 20.0;  // below this, keys are too sparse to be frames
constexpr double kUsualRate = 30.0;
constexpr double kFastestFrames = 250;  // per second; more are keys between frames
constexpr double kUnevenRate = 60.0;
constexpr double kMinFileRate = 0.001, kMaxFileRate = 100'000;  // of files, see check_frame_rate()
constexpr double kMaxFrames = 1e7;
constexpr double kMaxHold = 60.0;  // seconds before the first key that are kept

// The float rounding error of a time, in frames. From half a frame on, every time would match.
double float_rounding(double rate, double time) {
  return std::min(0.24, 2.4e-7 * std::abs(time) * rate);
}

// The max distance of a time from a frame, in frames: float rounding, plus that of printed times if
// they are one frame apart.
double tolerance(double rate, double time, bool printed) {
  return 0.01 + (printed ? std::min(0.04, 6e-4 * rate) : 0.0) + float_rounding(rate, time);
}

// The largest distance of a time from a frame at `rate`, in frames; nullopt if one is out of
// tolerance.
std::optional<double> misfit(const std::vector<double>& times, double rate, bool printed) {
  double worst = 0;
  for (const double time : times) {
    const double place = (time - times.front()) * rate;
    const double off = std::abs(place - std::round(place));
    if (!(off <= tolerance(rate, time, printed))) return std::nullopt;
    worst = std::max(worst, off);
  }
  return worst;
}

// As misfit, for times that come one per frame.
std::optional<double> even_misfit(const std::vector<double>& times, double rate) {
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (std::lround((times[i] - times.front()) * rate) != static_cast<long>(i)) return std::nullopt;
  }
  return misfit(times, rate, true);
}

// The fastest common rate on each of whose frames is a key, for times with others between them, as
// where a reader follows Euler angles that go far round.
std::optional<double> covered_rate(const std::vector<double>& times) {
  constexpr std::size_t kFewest = 10;
  std::optional<double> fastest;
  for (const double rate : kCommonRates) {
    std::size_t frames = 0;
    for (const double time : times) {
      const double place = (time - times.front()) * rate;
      if (std::lround(place) == static_cast<long>(frames) &&
          std::abs(place - std::round(place)) <= tolerance(rate, time, false)) {
        ++frames;
      }
    }
    const double all = (times.back() - times.front()) * rate + 1;
    const bool covered = std::abs(static_cast<double>(frames) - all) < 0.02;
    if (frames >= kFewest && covered && rate > fastest.value_or(0)) fastest = rate;
  }
  return fastest;
}

struct FoundRate {
  double rate = kUsualRate;
  bool on_keys = false;  // keys are on its frames
  std::string reason;
  Confidence confidence = Confidence::guess;
};

FoundRate find_rate(const std::vector<double>& times, double of_file) {
  if (of_file >= kMinFileRate && of_file <= kMaxFileRate && misfit(times, of_file, false)) {
    return {of_file, true, "as the file says; all keys are on its frames", Confidence::certain};
  }
  if (times.size() < 2) return {kUsualRate, true, "fewer than two keys", Confidence::guess};
  const auto even = even_rate(times);
  const double finer = even && of_file > 0 ? *even / of_file : 0;
  if (finer > 1.5 && *even > kFastestFrames && std::abs(finer - std::round(finer)) < 1e-6) {
    return {of_file, true,
            fmt::format("as the file's keys; its curves were resampled at {}", readable(*even)),
            Confidence::certain};
  }
  if (even && *even >= kMinRate) {
    return {*even, true, fmt::format("the keys are evenly spaced at {} fps", readable(*even)),
            Confidence::certain};
  }
  if (const auto grid = common_grid(times)) {
    return {*grid, true, fmt::format("all keys are on frames at {} fps", readable(*grid)),
            Confidence::likely};
  }
  if (const auto covered = covered_rate(times)) {
    return {*covered, true,
            fmt::format("each frame at {} fps has a key; others are between", readable(*covered)),
            Confidence::likely};
  }
  if (even) {
    return {kUnevenRate, false,
            fmt::format(
                "the keys are evenly spaced at {} fps, too sparse to be frames; the default is {}",
                readable(*even), readable(kUnevenRate)),
            Confidence::guess};
  }
  return {kUnevenRate, false,
          fmt::format("the keys are unevenly spaced; the default is {}", readable(kUnevenRate)),
          Confidence::guess};
}

// Whether frame 0 is at time 0, for a viewer that holds the first key until its time: where the
// keys are on frames counted from 0, at another rate in `found` if need be, or on none anyway.
bool starts_at_zero(const nodes::Animation& animation, std::vector<double> times,
                    const SamplingOptions& options, FoundRate& found) {
  if (!animation.from_zero || times.empty() || times.front() > kMaxHold) return false;
  if (times.front() == 0) return true;
  times.insert(times.begin(), 0.0);
  if (!found.on_keys || misfit(times, found.rate, false)) return true;
  const auto grid = common_grid(times);
  if (grid && !options.source_rate) {
    found = {*grid, true,
             fmt::format("all keys are on frames at {} fps from time 0", readable(*grid)),
             Confidence::likely};
    return true;
  }
  return options.rate.has_value() && !options.source_rate;
}

}  // namespace

std::vector<double> distinct_key_times(const nodes::Animation& animation) {
  std::unordered_set<const std::vector<float>*> seen;  // channels often share their times
  std::vector<double> times;
  for (const auto* channels : {&animation.channels, &animation.lenses}) {
    for (const nodes::Channel& channel : *channels) {
      if (!seen.insert(channel.times.get()).second) continue;
      times.insert(times.end(), channel.times->begin(), channel.times->end());
    }
  }
  std::sort(times.begin(), times.end());
  const auto same = [](double a, double b) { return b - a < 1e-6 + 2e-7 * std::abs(b); };
  times.erase(std::unique(times.begin(), times.end(), same), times.end());
  return times;
}

std::optional<double> even_rate(const std::vector<double>& times) {
  if (times.size() < 2) return std::nullopt;
  const double duration = times.back() - times.front();
  const double average = static_cast<double>(times.size() - 1) / duration;
  if (!std::isfinite(average) || average > 1e6) return std::nullopt;
  std::optional<double> best;
  double least = 0;
  for (const double rate : kCommonRates) {
    const auto off = even_misfit(times, rate);
    // Prefers an integer rate to an NTSC rate that does not fit better.
    if (off && (!best || *off < least - 2e-3)) {
      best = rate;
      least = *off;
    }
  }
  if (best) return best;
  const double whole = std::round(average);
  for (const double rate : {whole, average}) {
    if (rate > 0 && even_misfit(times, rate)) return rate;
  }
  return std::nullopt;
}

std::optional<double> common_grid(const std::vector<double>& times) {
  if (times.empty()) return std::nullopt;
  for (const double rate : kCommonRates) {
    // Nearly one each frame, but for a hold: times may be rounded as those of all frames are.
    std::size_t frames_long = 0;
    for (std::size_t i = 1; i < times.size(); ++i) {
      frames_long += std::lround((times[i] - times[i - 1]) * rate) == 1 ? 1 : 0;
    }
    const bool in_a_row = times.size() >= 10 && 10 * frames_long >= 9 * (times.size() - 1);
    if (misfit(times, rate, in_a_row)) return rate;
  }
  return std::nullopt;
}

Result<ChosenSampling> choose_sampling(const nodes::Animation& animation,
                                       const SamplingOptions& options, Diagnostics& diagnostics) {
  ChosenSampling chosen;
  std::vector<double> times = distinct_key_times(animation);
  if (!times.empty()) {
    chosen.keys_from = times.front();
    chosen.keys_to = times.back();
  }
  FoundRate found = find_rate(times, animation.rate);
  Sampling& sampling = chosen.sampling;
  const bool held = starts_at_zero(animation, std::move(times), options, found);
  sampling.start = held ? 0 : chosen.keys_from;
  sampling.rate = found.rate;
  chosen.rate = {readable(found.rate), found.reason, found.confidence};
  double stretch = 1.0;  // scene seconds per second of the result
  if (options.source_rate) {
    if (!found.on_keys) {
      return Error("scene-rate", "--fps takes the keys as frames, but they are unevenly spaced",
                   "use --rate N to set the frame rate of the result");
    }
    stretch = *options.source_rate / found.rate;
    sampling.rate = *options.source_rate;
    chosen.rate = {readable(sampling.rate), "as given", Confidence::certain};
  } else if (!options.rate) {
    diagnostics.push_back(make_diagnostic(
        Severity::note, "scene-rate", fmt::format("{} fps: {}", readable(found.rate), found.reason),
        "use --rate N for another rate"));
  }
  if (options.rate) sampling.rate = *options.rate;
  sampling.step = stretch / sampling.rate;

  const double steps = (chosen.keys_to - sampling.start) / sampling.step;
  if (!(steps < kMaxFrames)) {
    return Error("scene-too-long",
                 fmt::format("{} fps over {} s gives too many frames", readable(sampling.rate),
                             readable(chosen.keys_to - sampling.start)));
  }
  // A remainder within rounding adds no frame.
  const double rest = 1e-2 + float_rounding(1 / sampling.step, chosen.keys_to);
  sampling.frames = static_cast<int>(std::ceil(steps - rest)) + 1;
  sampling.frames = std::max(sampling.frames, 1);
  if (chosen.keys_from != 0 && held) {
    diagnostics.push_back(
        make_diagnostic(Severity::note, "scene-start",
                        fmt::format("frames before {} s hold the first key, as viewers show it",
                                    readable(chosen.keys_from))));
  } else if (chosen.keys_from != 0) {
    diagnostics.push_back(make_diagnostic(
        animation.from_zero ? Severity::warning : Severity::note, "scene-start",
        fmt::format("frame 0 is the file's first key, at {} s", readable(chosen.keys_from)),
        animation.from_zero && chosen.keys_from <= kMaxHold
            ? "viewers hold the first key until then; --rate N samples from time 0"
            : ""));
  }
  const double late = (sampling.frames - 1) - steps;
  if (late > 0.05) {
    diagnostics.push_back(make_diagnostic(
        Severity::note, "scene-end",
        fmt::format("the last key, at {} s, is between two frames; the last frame holds it, {} "
                    "frames late",
                    readable(chosen.keys_to), readable(late, 2))));
  }
  return chosen;
}

namespace {

constexpr int kParts = 4;           // of the time between two frames
constexpr double kOnFrame = 0.01;   // frames
constexpr std::size_t kTried = 16;  // of the times between two frames, the worst
constexpr int kMaxTimes = 32;       // the rate
constexpr double kFastest = 1000;   // frames per second that are suggested
constexpr std::size_t kGapsAtOnce = 16;

struct GapError {
  double largest = 0;
  int joint = -1;
  double time = 0;  // of the scene
};

class Sampled {
 public:
  Sampled(const nodes::Evaluator& evaluator, const Rig& rig, const Conversion& conversion,
          int animation)
      : evaluator_(evaluator), rig_(rig), conversion_(conversion), animation_(animation) {}

  // The largest error between two times with a frame each.
  GapError between(double begin, double end) const {
    nodes::Evaluation state;
    const std::vector<Transform> first = pose(begin, state), last = pose(end, state);
    GapError worst;
    std::vector<Transform> shown(first.size());
    for (int part = 1; part < kParts; ++part) {
      const double share = static_cast<double>(part) / kParts;
      const double time = begin + share * (end - begin);
      const std::vector<Transform> real = pose(time, state);
      for (std::size_t j = 0; j < shown.size(); ++j) {
        const int parent = rig_.skeleton.parents[j];
        const auto local = [&](const std::vector<Transform>& pose) {
          return parent < 0 ? pose[j] : pose[at(parent)].inverse() * pose[j];
        };
        const Transform a = local(first), b = local(last);
        const Transform here{a.position + share * (b.position - a.position),
                             slerp(a.orientation, b.orientation, share)};
        shown[j] = parent < 0 ? here : shown[at(parent)] * here;
        const double off = (shown[j].position - real[j].position).norm();
        if (off > worst.largest) worst = {off, static_cast<int>(j), time};
      }
    }
    return worst;
  }

 private:
  std::vector<Transform> pose(double time, nodes::Evaluation& state) const {
    evaluator_.place_nodes(animation_, time, state);
    std::vector<Transform> joints;
    for (int j = 0; j < rig_.joints.count(); ++j) {
      joints.push_back(conversion_.pose(nodes::rigid_part(rig_.joint_to_world(state, j))));
    }
    return joints;
  }

  const nodes::Evaluator& evaluator_;
  const Rig& rig_;
  const Conversion& conversion_;
  int animation_;
};

// The errors of gaps that a finer rate divides in `times` each.
std::vector<GapError> errors_of(const Sampled& sampled, const Sampling& sampling,
                                const std::vector<int>& gaps, int times, int jobs) {
  std::vector<GapError> errors(gaps.size());
  parallel_for(gaps.size(), kGapsAtOnce, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (int k = 0; k < times; ++k) {
        const double step = sampling.step / times, start = sampling.time(gaps[i]) + k * step;
        const GapError error = sampled.between(start, start + step);
        if (error.largest > errors[i].largest) errors[i] = error;
      }
    }
  });
  return errors;
}

GapError largest_of(const std::vector<GapError>& errors) {
  return *std::ranges::max_element(errors, {}, &GapError::largest);
}

}  // namespace

bool is_sampled_exactly(const nodes::Animation& animation, const Sampling& sampling) {
  return std::ranges::all_of(animation.channels, [&](const nodes::Channel& channel) {
    if (channel.times->size() < 2) return true;
    return channel.interpolation == nodes::Interpolation::linear &&
           std::ranges::all_of(*channel.times, [&](float time) {
             const double place = (static_cast<double>(time) - sampling.start) / sampling.step;
             return std::abs(place - std::round(place)) < kOnFrame;
           });
  });
}

SamplingError sampling_error(const nodes::Evaluator& evaluator, const Rig& rig,
                             const Conversion& conversion, const nodes::Animation& animation,
                             int index, const Sampling& sampling, double wanted, int jobs) {
  SamplingError result;
  std::vector<int> all;
  for (int gap = 0; gap + 1 < sampling.frames; ++gap) all.push_back(gap);
  if (all.empty() || is_sampled_exactly(animation, sampling)) return result;
  const Sampled sampled(evaluator, rig, conversion, index);
  const std::vector<GapError> errors = errors_of(sampled, sampling, all, 1, jobs);
  const GapError worst = largest_of(errors);
  result.largest = worst.largest;
  result.joint = worst.joint;
  result.time = (worst.time - sampling.start) / (sampling.step * sampling.rate);
  result.jumps = std::ranges::any_of(animation.channels, [](const nodes::Channel& channel) {
    return channel.interpolation == nodes::Interpolation::step && channel.times->size() > 1;
  });
  if (worst.largest <= wanted) return result;
  std::vector<int> hardest = all;
  const std::size_t tried = std::min(kTried, hardest.size());
  std::ranges::partial_sort(
      hardest, hardest.begin() + static_cast<std::ptrdiff_t>(tried),
      [&](int a, int b) { return errors[at(a)].largest > errors[at(b)].largest; });
  hardest.resize(tried);
  for (int times = 2; times <= kMaxTimes && sampling.rate * times <= kFastest; times *= 2) {
    if (largest_of(errors_of(sampled, sampling, hardest, times, jobs)).largest > wanted) continue;
    if (largest_of(errors_of(sampled, sampling, all, times, jobs)).largest > wanted) continue;
    result.rate = sampling.rate * times;
    break;
  }
  return result;
}

}  // namespace krok::character
