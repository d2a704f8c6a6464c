#include <algorithm>
#include <cmath>
#include <limits>

#include "math/window.h"
#include "plant/foot_paths_internal.h"

namespace krok::plant {

namespace {

constexpr double kLow = 0.008;      // of the leg, above the lowest point
constexpr double kMaxSlide = 0.07;  // of the leg
// Of the leg, of feet that have been planted: still enough to need nothing, and without doubt.
constexpr double kRolled = 2e-5, kExactly = 5e-6;
constexpr double kRolledPart = 0.5;

// Heights of the points of a flat foot: medians over frames in which heel and ball both stay,
// or in which one of them does.
std::vector<double> flat_heights(const Footing& footing) {
  const std::size_t heel = footing.index_of(FootPart::heel),
                    ball = footing.index_of(FootPart::ball);
  std::vector<std::vector<double>> above(footing.tracks.size());
  for (const bool both : {true, false}) {
    for (std::size_t f = 0; f < footing.stay_at[heel].size(); ++f) {
      const bool on_heel = footing.stay_at[heel][f] >= 0;
      const bool on_ball = ball < footing.parts.size() && footing.stay_at[ball][f] >= 0;
      if (both ? !on_heel || !on_ball : !on_heel && !on_ball) continue;
      for (std::size_t p = 0; p < above.size(); ++p) {
        above[p].push_back(footing.tracks[p][f].y() - footing.tracks[heel][f].y());
      }
    }
    if (!above.front().empty()) break;
  }
  std::vector<double> heights;
  for (std::vector<double>& of_point : above) {
    heights.push_back(of_point.empty() ? 0 : median(std::move(of_point)));
  }
  return heights;
}

class RollFinder {
 public:
  RollFinder(const Footing& footing, double leg_length)
      : footing_(footing), leg_(leg_length), flat_(flat_heights(footing)) {}

  // From `from`, a frame of a stay, to `to`.
  Roll roll(int from, int to) const {
    Roll roll{.from = from, .step = to < from ? -1 : 1, .points = {}, .slide = 0};
    Vec3 slid = Vec3::Zero();
    int still = 0, exact = 0;  // frames
    for (int f = from; f != to; f += roll.step) {
      const std::size_t point = in_contact(f, f + roll.step);
      slid += step_of(point, f, f + roll.step);
      if (slid.norm() > kMaxSlide * leg_) break;
      if (still == std::abs(f - from) && slid.norm() < kRolled * leg_) ++still;
      if (exact == std::abs(f - from) && slid.norm() < kExactly * leg_) ++exact;
      roll.points.push_back(static_cast<int>(point));
      roll.slide = std::max(roll.slide, slid.norm());
    }
    // Of a foot that has been planted: what is beyond is of a step.
    if (exact < 2 &&
        (still == 0 || still < kRolledPart * static_cast<double>(roll.points.size()))) {
      return roll;
    }
    roll.points.resize(static_cast<std::size_t>(std::max(exact < 2 ? 0 : exact, still)));
    roll.slide = 0;
    return roll;
  }

 private:
  double above(std::size_t point, int frame) const {
    return footing_.tracks[point][static_cast<std::size_t>(frame)].y() - flat_[point];
  }
  // Along the ground.
  Vec3 step_of(std::size_t point, int from, int to) const {
    const auto& track = footing_.tracks[point];
    const Vec3 step = track[static_cast<std::size_t>(to)] - track[static_cast<std::size_t>(from)];
    return {step.x(), 0, step.z()};
  }
  // Of the points that are lowest, compared with a flat foot, the one that moves least.
  std::size_t in_contact(int from, int to) const {
    double lowest = above(0, from), least = std::numeric_limits<double>::infinity();
    for (std::size_t p = 1; p < flat_.size(); ++p) lowest = std::min(lowest, above(p, from));
    std::size_t point = 0;
    for (std::size_t p = 0; p < flat_.size(); ++p) {
      const double slide = step_of(p, from, to).norm(), higher = above(p, from) - lowest;
      const double low = slide < kExactly * leg_ ? 2 * kLow : kLow;
      if (higher <= low * leg_ && slide < least) least = slide, point = p;
    }
    return point;
  }

  const Footing& footing_;
  double leg_;
  std::vector<double> flat_;
};

}  // namespace

void find_rolls(std::span<const StanceTimes> stances, double rate, double leg_length,
                Footing& footing) {
  footing.rolls.clear();
  if (footing.stays.empty()) return;
  const RollFinder finder(footing, leg_length);
  const int frames = static_cast<int>(footing.tracks.front().size());
  const auto touches = [&](int frame) {
    for (std::size_t p = 0; p < footing.parts.size(); ++p) {
      if (footing.parts[p] == FootPart::tip) continue;
      if (footing.stay_at[p][static_cast<std::size_t>(frame)] >= 0) return true;
    }
    return false;
  };
  for (const StanceTimes& stance : stances) {
    const int strike = std::max(0, static_cast<int>(std::ceil(stance.strike * rate - 1e-3)));
    const int off = std::min(frames - 1, static_cast<int>(std::floor(stance.off * rate + 1e-3)));
    int first = strike, last = off;
    while (first <= off && !touches(first)) ++first;
    while (last >= first && !touches(last)) --last;
    if (first > last) continue;
    for (Roll roll : {finder.roll(first, strike), finder.roll(last, off)}) {
      if (!roll.points.empty()) footing.rolls.push_back(std::move(roll));
    }
  }
}

double slide_of(const std::vector<Footing>& footings) {
  double slide = 0;
  for (const Footing& footing : footings) {
    for (const Roll& roll : footing.rolls) slide = std::max(slide, roll.slide);
  }
  return slide;
}

}  // namespace krok::plant
