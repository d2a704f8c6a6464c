#include "plant/foot_paths_internal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/quaternion.h"
#include "plant/smooth_curve_internal.h"

namespace krok::plant {

namespace {

constexpr double kFade = 1.0;          // seconds
constexpr double kJoin = 0.05;         // seconds
constexpr double kJitterSpeed = 0.03;  // metres a second, for a leg of 0.86 m
constexpr double kUsualLeg = 0.86;     // metres
constexpr double kFootLength = 0.22;   // of the leg, heel to ball
constexpr double kSharedCutoff = 4;    // Hz, of what counts as jitter that feet and pelvis share

class FootSolver {
 public:
  FootSolver(const Clip& clip, const PlantedBody& body, const Leg& leg, const Footing& footing)
      : clip_(clip),
        leg_(leg),
        footing_(footing),
        speed_(kJitterSpeed * body.leg_length / kUsualLeg),
        lever_(kFootLength * body.leg_length),
        frames_(static_cast<std::size_t>(clip.frame_count())),
        ball_(index_of(FootPart::ball)),
        tip_(index_of(FootPart::tip)) {}

  std::vector<Vec3> turns() const {
    KnownCurve turn(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      const FixedStay *heel = stay(0, f), *ball = ball_ < 0 ? nullptr : stay(ball_, f);
      if (!heel || !ball) continue;
      const Vec3 now = track(ball_)[f] - track(0)[f];
      turn.set(f, rotation_vector(shortest_arc(now, ball->place - heel->place)));
    }
    const double cutoff = cutoff_against(jitter_of(turn), speed_ / lever_, clip_.rate);
    return curve_through(turn, clip_.rate, cutoff, kFade, kJoin);
  }

  // What brings the point that stands to its place, once the foot is turned.
  KnownCurve shifts(const std::vector<Vec3>& turn) const {
    KnownCurve shift(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      for (const int point : {0, ball_}) {
        const FixedStay* fixed = point < 0 ? nullptr : stay(point, f);
        if (!fixed) continue;
        shift.set(f, fixed->place - turned(point, f, turn[f]));
        break;
      }
    }
    if (tip_ >= 0) hold_tip(turn, shift);
    return shift;
  }

  double speed() const { return speed_; }

 private:
  int index_of(FootPart part) const {
    for (std::size_t p = 0; p < leg_.points.size(); ++p) {
      if (leg_.points[p].part == part) return static_cast<int>(p);
    }
    return -1;
  }
  const std::vector<Vec3>& track(int point) const {
    return footing_.tracks[static_cast<std::size_t>(point)];
  }
  const FixedStay* stay(int point, std::size_t f) const {
    const int at = footing_.stay_at[static_cast<std::size_t>(point)][f];
    return at < 0 ? nullptr : &footing_.stays[static_cast<std::size_t>(at)];
  }

  // Where a point is after the turn about the ankle.
  Vec3 turned(int point, std::size_t f, const Vec3& turn) const {
    const int frame = static_cast<int>(f);
    const Vec3 ankle = joint_at(clip_, frame, leg_.foot).position;
    const Vec3 place = track(point)[f];
    const Quat of_foot = from_rotation_vector(turn);
    if (leg_.toes < 0 || point != tip_) return ankle + of_foot * Vec3(place - ankle);
    const Vec3 toes = joint_at(clip_, frame, leg_.toes).position;
    return ankle + of_foot * Vec3(toes - ankle) +
           from_rotation_vector(turn_of_toes(turn)) * Vec3(place - toes);
  }

  // Where the tip alone stands it stays where it is when heel or ball leave, or come down.
  void hold_tip(const std::vector<Vec3>& turn, KnownCurve& shift) const {
    for (std::size_t i = 0; i < footing_.stays.size(); ++i) {
      const FixedStay& fixed = footing_.stays[i];
      if (fixed.point.part != FootPart::tip) continue;
      const auto first = static_cast<std::size_t>(fixed.first);
      const auto last = static_cast<std::size_t>(fixed.last);
      std::vector<std::uint8_t> held(shift.known.begin() + fixed.first,
                                     shift.known.begin() + fixed.last + 1);
      const bool alone = std::ranges::count(held, 1) == 0;
      const auto hold = [&](std::size_t f, const Vec3& place) {
        if (!held[f - first]) shift.set(f, place - turned(tip_, f, turn[f]));
      };
      if (alone) {
        for (std::size_t f = first; f <= last; ++f) hold(f, fixed.place);
        continue;
      }
      std::size_t from = first;
      while (!held[from - first]) ++from;
      Vec3 place = turned(tip_, from, turn[from]) + shift.values[from];
      for (std::size_t f = first; f < from; ++f) hold(f, place);
      for (std::size_t f = from; f <= last; ++f) {
        if (held[f - first]) place = turned(tip_, f, turn[f]) + shift.values[f];
        hold(f, place);
      }
    }
  }

  const Clip& clip_;
  const Leg& leg_;
  const Footing& footing_;
  double speed_, lever_;
  std::size_t frames_;
  int ball_, tip_;
};

// What is left of a curve after its slow part.
KnownCurve fast_part(const KnownCurve& curve, double rate) {
  const std::vector<Vec3> slow = smooth_curve(curve, rate, kSharedCutoff, kFade);
  KnownCurve fast(curve.values.size());
  for (std::size_t f = 0; f < slow.size(); ++f) {
    if (curve.known[f]) fast.set(f, curve.values[f] - slow[f]);
  }
  return fast;
}

// The jitter that feet and pelvis share, negative: what takes it out. Each foot that stands shows
// it, with an error of its own; so does the pelvis, with what it really moves. Their covariance is
// its variance, and what they vary by beyond that their errors'; the estimate is the mean with the
// inverse variances as weights, and with zero at the jitter's own (Wiener).
std::vector<Vec3> shared_jitter(const Clip& clip, int pelvis,
                                const std::vector<KnownCurve>& shifts) {
  const std::size_t frames = shifts.front().values.size();
  std::vector<Vec3> result(frames, Vec3::Zero());
  KnownCurve hips(frames);
  for (std::size_t f = 0; f < frames; ++f) {
    hips.set(f, -joint_at(clip, static_cast<int>(f), pelvis).position);
  }
  hips = fast_part(hips, clip.rate);
  std::vector<KnownCurve> feet;
  for (const KnownCurve& shift : shifts) feet.push_back(fast_part(shift, clip.rate));
  double both = 0, of_feet = 0, of_hips = 0;
  int count = 0;
  for (const KnownCurve& foot : feet) {
    for (std::size_t f = 0; f < frames; ++f) {
      if (!foot.known[f]) continue;
      both += foot.values[f].dot(hips.values[f]);
      of_feet += foot.values[f].squaredNorm();
      of_hips += hips.values[f].squaredNorm();
      ++count;
    }
  }
  if (count < 3 || !(both > 0)) return result;
  constexpr double kLeast = 1e-3;  // of the jitter's variance
  const double foot_weight = both / std::max(of_feet - both, kLeast * both);
  const double hips_weight = both / std::max(of_hips - both, kLeast * both);
  for (std::size_t f = 0; f < frames; ++f) {
    Vec3 sum = hips_weight * hips.values[f];
    double weight = 1 + hips_weight;
    for (const KnownCurve& foot : feet) {
      if (!foot.known[f]) continue;
      sum += foot_weight * foot.values[f];
      weight += foot_weight;
    }
    result[f] = sum / weight;
  }
  return result;
}

}  // namespace

Paths foot_paths(const Clip& clip, const PlantedBody& body, const std::vector<Footing>& footings) {
  Paths paths;
  std::vector<KnownCurve> shifts;
  std::vector<double> speeds;
  for (std::size_t i = 0; i < body.legs.size(); ++i) {
    const FootSolver solver(clip, body, body.legs[i], footings[i]);
    paths.feet.push_back({solver.turns(), {}});
    shifts.push_back(solver.shifts(paths.feet.back().turn));
    speeds.push_back(solver.speed());
  }
  paths.body = shared_jitter(clip, body.pelvis, shifts);
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    KnownCurve& shift = shifts[i];
    for (std::size_t f = 0; f < paths.body.size(); ++f) {
      if (shift.known[f]) shift.values[f] -= paths.body[f];
    }
    const double cutoff = cutoff_against(jitter_of(shift), speeds[i], clip.rate);
    std::vector<Vec3> curve = curve_through(shift, clip.rate, cutoff, kFade, kJoin);
    for (std::size_t f = 0; f < curve.size(); ++f) curve[f] += paths.body[f];
    paths.feet[i].shift = std::move(curve);
  }
  return paths;
}

}  // namespace krok::plant
