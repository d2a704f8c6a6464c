#include <algorithm>
#include <array>
#include <cmath>

#include "core/index.h"
#include "lint/series_internal.h"
#include "math/window.h"

// jitter, over-smooth and frozen: how much fine detail a stretch has.

namespace krok::lint {

namespace {

constexpr double kWindow = 0.5;            // seconds
constexpr double kMedianOfNorm = 1.538;    // of three normal variables (Maxwell distribution)
constexpr double kQuartileOfNorm = 1.101;  // the lower one
constexpr std::ptrdiff_t kOfAJerk = 2;     // fourth differences on either side that one jerk is in
constexpr double kFourthDifference = 70;   // its variance over that of white noise: 1+16+36+16+1
// Lag-1 correlation of accelerations: -2/3 for white noise, near 1 for a smooth motion.
constexpr double kNoiseLike = -0.45;
constexpr float kMoves = 2e-3F;          // rad a frame
constexpr double kDeviations = 5;        // of the detail of a motion's windows
constexpr std::size_t kFewest = 8;       // windows, 2.25 s, that show what detail is usual
constexpr double kFrozenLongest = 3600;  // seconds
// A keyed pose is eased into and out of; a take that drops out stops or goes on at full speed.
constexpr double kEdge = 0.1;   // seconds beside a hold
constexpr float kEased = 0.4F;  // of the fastest frame there, of the one next to the hold
// Motions that are generated begin and end at rest, at a tenth of the usual speed or less, and
// are eased out of it and into it for so long, seconds.
constexpr float kRest = 0.1F;
constexpr double kEase = 0.75;

// What a window of one joint shows; the windows overlap by half.
struct Detail {
  float noise = 0;        // rad, the standard deviation of each axis
  float jitter = 0;       // the same by the calmer quarter of the window
  float correlation = 1;  // of successive accelerations
  float speed = 0;        // rad a frame, root mean square
  float usual = 0;        // rad a frame, of the slower half, which a jump leaves as it is
};

struct Windows {
  int length = 0, stride = 0, count = 0;
  int first(int window) const { return 1 + window * stride; }  // a turn's frame
  Span span(int window) const {
    const int before = first(window) - 1;
    return {before, before + length, before + length / 2};
  }
};

Windows windows_of(const Series& series) {
  Windows windows;
  windows.length = series.frames_in(kWindow, 12);
  windows.stride = windows.length / 2;
  const int turns = series.frames - 1;
  windows.count = turns < windows.length ? 0 : 1 + (turns - windows.length) / windows.stride;
  return windows;
}

// What the frames of one joint add to their windows, [frames]; accelerations are changes of turns.
struct Sizes {
  std::vector<float> turn, acceleration, product;  // squares, and products of successive ones
  std::vector<float> noise;                        // squares of fourth differences of rotations
  std::vector<float> sorted;
};

// Details of one joint, [windows]; without noise where it is slower than `still`, rad a frame, and
// jitter where noise is not over the limit.
void look_at(std::span<const Vec3f> turns, const Windows& windows, float still, double limit,
             Sizes& sizes, std::vector<Detail>& details) {
  for (auto* list : {&sizes.turn, &sizes.acceleration, &sizes.product, &sizes.noise}) {
    list->resize(turns.size());
  }
  Vec3f one = Vec3f::Zero(), two = Vec3f::Zero();
  for (std::size_t f = 1; f < turns.size(); ++f) {
    const Vec3f now = turns[f] - turns[f - 1];
    sizes.turn[f] = turns[f].squaredNorm();
    sizes.acceleration[f] = now.squaredNorm();
    sizes.product[f] = now.dot(one);
    sizes.noise[f] = (now - 2 * one + two).squaredNorm();
    two = one, one = now;
  }
  details.resize(at(windows.count));
  for (int w = 0; w < windows.count; ++w) {
    const std::size_t first = at(windows.first(w)), end = first + at(windows.length);
    double products = 0, accelerations = 0;
    std::array<double, 2> squares = {sizes.turn[first], 0};
    const std::size_t half = at(windows.length / 2);
    for (std::size_t f = first + 1; f < end; ++f) {
      squares[f < first + half ? 0 : 1] += sizes.turn[f];
      accelerations += sizes.acceleration[f];
      products += f > first + 1 ? sizes.product[f] : 0;
    }
    Detail& detail = details[at(w)] = {};
    detail.correlation = accelerations > 0 ? static_cast<float>(products / accelerations) : 1.0F;
    detail.speed = static_cast<float>(std::sqrt((squares[0] + squares[1]) / windows.length));
    if (detail.speed < still) continue;
    detail.usual =
        static_cast<float>(std::sqrt(std::ranges::min(squares) / static_cast<double>(half)));
    const auto place = [&](std::size_t f) {
      return sizes.noise.begin() + static_cast<std::ptrdiff_t>(f);
    };
    sizes.sorted.assign(place(first + 3), place(end));
    const auto quantile = [&](std::size_t quarters, double of_norm) {
      const auto nth =
          sizes.sorted.begin() + static_cast<std::ptrdiff_t>(quarters * sizes.sorted.size() / 4);
      std::ranges::nth_element(sizes.sorted, nth);
      return static_cast<float>(std::sqrt(*nth / kFourthDifference) / of_norm);
    };
    detail.noise = quantile(2, kMedianOfNorm);
    if (detail.noise <= limit) continue;
    // A jerky gesture of half of the window is no noise, nor is one jerk, as of a foot that lands,
    // which at low rates is in most of a window's differences.
    const auto worst = std::max_element(place(first + 3), place(end));
    sizes.sorted.clear();
    for (auto size = place(first + 3); size != place(end); ++size) {
      if (std::abs(size - worst) > kOfAJerk) sizes.sorted.push_back(*size);
    }
    if (!sizes.sorted.empty()) detail.jitter = quantile(1, kQuartileOfNorm);
  }
}

void find_jitter(const Series& series, int joint, const Windows& windows,
                 std::span<const Detail> details, std::vector<Finding>& found) {
  const double limit = series.threshold(Rule::jitter) * kRadiansPerDegree;
  for (int w = 0; w < windows.count; ++w) {
    const Detail& detail = details[at(w)];
    if (detail.jitter <= limit || detail.correlation > kNoiseLike) continue;
    found.push_back(
        finding_of(Rule::jitter, series, detail.noise / kRadiansPerDegree, windows.span(w)));
    found.back().joint = joint;
  }
}

// How much detail a motion has for its speed, as a logarithm: [windows], the median over the joints
// that move; not a number where less than four do.
class DetailOfBody {
 public:
  explicit DetailOfBody(int windows) : ratios_(at(windows)) {}
  void add(std::span<const Detail> details) {
    for (std::size_t w = 0; w < details.size(); ++w) {
      if (details[w].speed < kMoves || details[w].usual < kStill) continue;  // or is held
      const float speed = std::max(details[w].usual, kMoves);
      ratios_[w].push_back(std::log(std::max(details[w].noise, 1e-7F) / speed));
    }
  }
  std::vector<double> medians() const {
    std::vector<double> all;
    for (const auto& ratios : ratios_) {
      all.push_back(ratios.size() < 4 ? NAN : median({ratios.begin(), ratios.end()}));
    }
    return all;
  }

 private:
  std::vector<std::vector<float>> ratios_;
};

// Windows in which a motion is eased out of a rest or into one are not judged: not a number.
void leave_out_rests(const Series& series, const Windows& windows, std::vector<double>& detail) {
  std::vector<float> speeds(series.moved.begin() + 1, series.moved.end());
  const auto upper = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() * 3 / 4);
  std::ranges::nth_element(speeds, upper);
  const int ease = series.frames_in(kEase, 1), last = series.frames - 1;
  const bool from_rest = series.moved[1] < kRest * *upper,
             to_rest = series.moved[at(last)] < kRest * *upper;
  for (int w = 0; w < windows.count; ++w) {
    const int first = windows.first(w), end = first + windows.length;
    if ((from_rest && first <= 1 + ease) || (to_rest && end > last - ease)) detail[at(w)] = NAN;
  }
}

void find_smooth(const Series& series, const Windows& windows, const DetailOfBody& body,
                 std::vector<Finding>& found) {
  std::vector<double> detail = body.medians();
  leave_out_rests(series, windows, detail);
  std::vector<double> known;
  std::ranges::copy_if(detail, std::back_inserter(known), [](double v) { return !std::isnan(v); });
  if (known.size() < kFewest) return;
  // What is smoothed may be over half of a take: the usual is that of the windows with more detail.
  const auto upper = known.begin() + static_cast<std::ptrdiff_t>(known.size() * 3 / 4);
  std::ranges::nth_element(known, upper);
  const double usual = *upper, limit = series.threshold(Rule::over_smooth);
  std::erase_if(known, [&](double value) { return usual - value >= std::log(limit); });
  const double middle = median(known);
  std::vector<double> off;
  for (const double value : known) off.push_back(std::abs(value - middle));
  const double spread = 1.4826 * median(off);
  for (int w = 0; w < windows.count; ++w) {
    const double less = usual - detail[at(w)];
    if (std::isnan(less) || less < std::log(limit) || less < kDeviations * spread) continue;
    found.push_back(finding_of(Rule::over_smooth, series, std::exp(less), windows.span(w)));
    found.back().detail = "times less detail than the rest of the motion";
  }
}

// Stretches [first, end) in which the whole body is still.
struct Holds {
  std::vector<std::pair<int, int>> dropped;  // or of the take's beginning or end
  bool keyed = false;                        // there are others, which are eased into and out of
};

Holds holds_of(const Series& series) {
  const int shortest = series.frames_in(series.threshold(Rule::frozen), 3),
            reach = series.frames_in(kEdge, 4);
  const auto is_slow = [&](int frame, int from) {
    const auto fastest = std::max_element(&series.moved[at(from)], &series.moved[at(from)] + reach);
    return series.moved[at(frame)] < kEased * *fastest;
  };
  const auto is_still = [&](int f) { return f > 0 && series.moved[at(f)] < kStill; };
  Holds holds;
  for (const auto& [first, end] : runs_of(series.frames, is_still)) {
    if (end - first < shortest) continue;
    const bool eased = first > reach && end + reach <= series.frames &&
                       is_slow(first - 1, first - reach) && is_slow(end, end);
    if (eased) {
      holds.keyed = true;
    } else {
      holds.dropped.emplace_back(first, end);
    }
  }
  return holds;
}

void find_frozen(const Series& series, const Holds& holds, std::vector<Finding>& found) {
  const auto moving =
      std::ranges::count_if(series.moved, [](float moved) { return moved > 1e-4F; });
  // A pose that is held all the time is a pose and no fault.
  if (moving < series.frames / 10 + 2) return;
  for (const auto& [first, end] : holds.dropped) {
    if (holds.keyed && (first == 1 || end == series.frames)) continue;
    found.push_back(finding_of(Rule::frozen, series,
                               std::min(kFrozenLongest, (end - first) / series.rate),
                               {first - 1, end - 1, first - 1}));
    found.back().threshold = series.frames_in(series.threshold(Rule::frozen), 3) / series.rate;
  }
}

}  // namespace

void find_noise_faults(const Series& series, MotionFaults& out) {
  std::vector<Finding> found;
  const Holds holds = holds_of(series);
  if (series.has(Rule::jitter) || series.has(Rule::over_smooth)) {
    const Windows windows = windows_of(series);
    DetailOfBody body(windows.count);
    // Noise is at most 1.14 times the speed, so slower joints have none that counts.
    const double limit = series.threshold(Rule::jitter) * kRadiansPerDegree;
    const float still = std::min(kMoves, static_cast<float>(limit / 1.2));
    Sizes sizes;
    std::vector<Detail> details;
    for (int j = 0; j < series.joints; ++j) {
      if (std::sqrt(series.largest[at(j)]) < 0.99F * still) continue;
      if (series.clip.skeleton.end_sites[at(j)] != 0) continue;
      look_at(series.turns_of(j), windows, still, limit, sizes, details);
      // Toes give way to the ground and spring back, as fast as noise.
      const Role role = series.roles.roles[at(j)];
      if (role != Role::left_toes && role != Role::right_toes) {
        find_jitter(series, j, windows, details, found);
      }
      body.add(details);
    }
    if (series.has(Rule::over_smooth) && holds.keyed) {
      out.notes.emplace_back("over-smooth: poses are keyed, which leaves no detail of a capture");
    } else if (series.has(Rule::over_smooth)) {
      find_smooth(series, windows, body, found);
    }
  }
  if (series.has(Rule::frozen)) find_frozen(series, holds, found);
  merge_joints(found, 1);
  out.findings.insert(out.findings.end(), found.begin(), found.end());
}

}  // namespace krok::lint
