#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "lint/soles_internal.h"

// ground: feet and bodies below or above it.

namespace krok::lint {

namespace {

constexpr double kSoftTip = 0.5;         // of the threshold, that tips of toes may be deeper
constexpr double kSeldom = 0.1;          // of the time; feet that stand for less show no ground
constexpr double kUneven = 0.1;          // metres, of heights of contacts on level ground
constexpr double kFloor = 2;             // times the threshold, of the floor's height
constexpr double kUpright = 0.8;         // of the legs' length, height of the hips
constexpr double kShortestHover = 0.25;  // seconds
constexpr double kShortestSink = 0.05;   // seconds; what is shorter is a pop
constexpr double kMinFall = 4;           // metres per second squared

struct Level {
  double height = 0;
  double spread = 0;  // of the middle 80 % of the time that feet stand
  double seconds = 0;
  bool known = false;
};

// Of a track, or -1: of all.
Level level_of(const Soles& soles, int track = -1) {
  std::vector<std::pair<double, double>> heights;  // and seconds
  double total = 0;
  for (const Stay& stay : soles.found.stays) {
    if (track >= 0 && stay.track != track) continue;
    const double seconds = stay.end - stay.start;
    heights.emplace_back(stay.place.y(), seconds);
    total += seconds;
  }
  if (total <= 0) return {};
  std::ranges::sort(heights);
  const auto at_part = [&](double part) {
    double sum = 0;
    for (const auto& [height, seconds] : heights) {
      sum += seconds;
      if (sum >= part * total) return height;
    }
    return heights.back().first;
  };
  return {at_part(0.5), at_part(0.9) - at_part(0.1), total, true};
}

class GroundRule {
 public:
  GroundRule(const Series& series, const Soles& soles, MotionFaults& out)
      : series_(series), soles_(soles), out_(out), level_(level_of(soles)) {
    limit_ = series.threshold(Rule::ground) * series.scale;
    marked_ = std::ranges::any_of(soles.found.tracks,
                                  [](const PointTrack& track) { return !track.point.estimated; });
    for (int t = 0; t < static_cast<int>(soles.places.size()); ++t) {
      const Level own = series.options.ground ? Level() : level_of(soles, t);
      longest_ = std::max(longest_, own.seconds);
      lower_.push_back(own.known ? std::clamp(level_.height - own.height, 0.0, limit_) : 0);
      if (soles.point(t).part == FootPart::tip) lower_.back() += kSoftTip * limit_;
    }
    for (const Stay& stay : soles.found.stays) {
      const std::size_t side = soles.side(stay.track);
      if (soles.ankles[side].empty()) continue;
      const auto middle = static_cast<int>(0.5 * (stay.start + stay.end) * series.rate);
      const double height = soles.ankles[side][at(std::min(middle, series.frames - 1))].y();
      ankle_levels_[side] = std::min(ankle_levels_[side], height);
    }
  }

  void find() {
    if (!series_.options.ground) {
      if (!level_.known) {
        out_.notes.emplace_back("ground: no foot stands anywhere, so the ground is not known");
        return;
      }
      if (longest_ < kSeldom * series_.frames / series_.rate) {
        out_.notes.emplace_back("ground: feet stand too seldom to show where the ground is");
        return;
      }
      if (level_.spread > kUneven * series_.scale) {
        out_.notes.push_back(fmt::format(
            "ground: the feet stand at heights that differ by {} m; --ground says what is below",
            readable(level_.spread, 2)));
        return;
      }
      if (std::abs(level_.height) > kFloor * limit_ && stands_mostly()) {
        add("floor", {0, series_.frames - 1, 0}, std::abs(level_.height));
        out_.findings.back().threshold = kFloor * limit_;
      }
    }
    find_sinking();
    find_hovering();
  }

 private:
  // Not of who sits: the feet may be on what carries the seat.
  bool stands_mostly() const {
    double on_feet = 0, all = 0;
    for (const Stay& stay : soles_.found.stays) {
      const auto middle = static_cast<int>(0.5 * (stay.start + stay.end) * series_.rate);
      all += stay.end - stay.start;
      if (stands(series_, soles_, stay.track, std::min(middle, series_.frames - 1))) {
        on_feet += stay.end - stay.start;
      }
    }
    return on_feet > all / 2;
  }

  std::optional<double> ground_at(const Vec3& point) const {
    return series_.options.ground ? series_.options.ground(point) : level_.height;
  }

  void add(const char* kind, const Span& span, double value, int joint = -1) {
    Finding& finding = out_.findings.emplace_back(finding_of(Rule::ground, series_, value, span));
    finding.kind = kind, finding.joint = joint;
  }

  // How deep a point is in the ground: beside a riser that is not far off, how deep it is before
  // it.
  double depth_of(const Vec3& place, double ground) const {
    double depth = ground - place.y();
    for (int k = 0; k < 8 && depth > limit_ && series_.options.ground; ++k) {
      const double angle = k * kPi / 4;
      const auto beside = ground_at(place + limit_ * Vec3(std::sin(angle), 0.0, std::cos(angle)));
      if (beside) depth = std::min(depth, std::max(0.0, *beside - place.y()));
    }
    return depth;
  }

  // How deep the deepest point of the soles is, and its joint.
  std::pair<double, int> deepest(int frame) const {
    std::pair<double, int> deepest(0, -1);
    for (std::size_t t = 0; t < soles_.places.size(); ++t) {
      const SolePoint& point = soles_.found.tracks[t].point;
      if (marked_ && point.estimated) continue;
      const Vec3& place = soles_.places[t][at(frame)];
      const auto ground = ground_at(place);
      if (!ground || *ground - lower_[t] - place.y() <= deepest.first) continue;
      double depth = depth_of(place, *ground - lower_[t]);
      const auto side = static_cast<std::size_t>(point.side);
      if (!series_.options.ground && !soles_.ankles[side].empty()) {
        depth = std::min(depth, ankle_levels_[side] - soles_.ankles[side][at(frame)].y());
      }
      if (depth > deepest.first) deepest = {depth, point.joint};
    }
    return deepest;
  }

  void find_sinking() {
    std::vector<std::pair<double, int>> depths;
    for (int f = 0; f < series_.frames; ++f) depths.push_back(deepest(f));
    const auto is_deep = [&](int f) { return depths[at(f)].first > limit_; };
    for (const auto& [first, end] : runs_of(series_.frames, is_deep)) {
      if (end - first < series_.frames_in(kShortestSink, 2)) continue;
      int worst = first;
      for (int f = first; f < end; ++f) worst = depths[at(f)] > depths[at(worst)] ? f : worst;
      add("sinking", {first, end - 1, worst}, depths[at(worst)].first, depths[at(worst)].second);
    }
  }

  // Height of the lowest joint above the ground, infinite where there is none; of one that is not
  // over the limit where there is one.
  double clearance(int frame) const {
    double lowest = INFINITY;
    const auto is_low = [&](const Vec3& place) {
      const auto ground = ground_at(place);
      if (ground) lowest = std::min(lowest, place.y() - *ground);
      return lowest <= limit_;
    };
    for (const auto& places : soles_.places) {
      if (is_low(places[at(frame)])) return lowest;
    }
    for (const Vec3f& place : series_.clip.frame_positions(frame)) {
      if (is_low(place.cast<double>())) return lowest;
    }
    return lowest;
  }

  // Bodies in the air fall; those that do not hang, are carried or float.
  void find_hovering() {
    std::vector<double> over(at(series_.frames), 0.0);
    for (int f = 0; f < series_.frames; ++f) {
      const Vec3 hips = series_.clip.frame_positions(f)[at(series_.carrier)].cast<double>();
      const auto ground = ground_at(hips);
      if (!ground || hips.y() - *ground < kUpright * soles_.found.leg_length) continue;
      over[at(f)] = clearance(f);
    }
    const auto is_over = [&](int f) { return over[at(f)] > limit_ && std::isfinite(over[at(f)]); };
    for (const auto& [first, end] : runs_of(series_.frames, is_over)) {
      if (end - first < series_.frames_in(kShortestHover, 4) ||
          series_.fall(first, end - 1) >= kMinFall ||
          series_.fall(first, end - 1, true) >= kMinFall) {
        continue;
      }
      const auto highest = std::max_element(&over[at(first)], &over[at(end - 1)] + 1);
      add("hovering", {first, end - 1, static_cast<int>(highest - over.data())}, *highest);
    }
  }

  const Series& series_;
  const Soles& soles_;
  MotionFaults& out_;
  Level level_;
  double longest_ = 0;  // seconds that one point of the soles stands
  double limit_ = 0;
  bool marked_ = false;  // joints mark points of the soles; what is estimated sinks nowhere then
  // [tracks], metres below the level that a point stands: the height of ankles and balls over the
  // sole is not known, and toes of many skeletons do not bend where heels rise.
  std::vector<double> lower_;
  // [FootSide], of the lowest contact of a foot without marked points.
  std::array<double, 2> ankle_levels_ = {INFINITY, INFINITY};
};

}  // namespace

void find_ground_faults(const Series& series, const Soles& soles, MotionFaults& out) {
  GroundRule(series, soles, out).find();
}

}  // namespace krok::lint
