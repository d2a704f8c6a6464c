#include <algorithm>
#include <array>
#include <cmath>

#include "math/window.h"
#include "plant/foot_paths_internal.h"
#include "plant/smooth_curve_internal.h"

namespace krok::plant {

namespace {

constexpr double kFarFromPlace = 0.2;  // of the leg
constexpr double kRisesFor = 0.1;      // seconds
constexpr double kOffGround = 0.012;   // of the leg
constexpr double kJitter = 0.002;      // metres, less does not matter to a place
constexpr double kUneven = 1.5;        // deviations
constexpr int kDistanceRounds = 200;
constexpr double kStillPart = 0.5;  // of a stay
// Of feet that have been planted, metres for a leg of one: people who stand move by more between
// few frames, at 120 Hz, too.
constexpr double kStill = 4e-5;
constexpr int kFewFrames = 4;
constexpr double kExact = 1e-8;  // metres

Vec3 median_place(const std::vector<Vec3>& track, int first, int last) {
  return krok::median_place(std::span(track).subspan(static_cast<std::size_t>(first),
                                                     static_cast<std::size_t>(last - first + 1)));
}

// The mean height of a stay without a tenth of its frames at either end of the order: more exact
// than the median where heights jitter evenly.
double trimmed_height(const std::vector<Vec3>& track, int first, int last) {
  std::vector<double> heights;
  for (int f = first; f <= last; ++f) heights.push_back(track[static_cast<std::size_t>(f)].y());
  std::ranges::sort(heights);
  const std::size_t cut = heights.size() / 10;
  double sum = 0;
  for (std::size_t i = cut; i < heights.size() - cut; ++i) sum += heights[i];
  return sum / static_cast<double>(heights.size() - 2 * cut);
}

// Variances of the median of n Gaussian values, of that mean and of their difference, in units of
// the values' variance / n.
constexpr double kOfMedian = 0.5 * kPi, kOfTrimmed = 1.06, kOfDifference = 0.45;

// Moves the places of a heel and a ball that stand together to their distance in the foot; heights
// stay as far as that allows.
struct Pair {
  int heel = 0, ball = 0;  // indices into the stays
  double distance = 0;     // metres
};

void bring_to_distance(const Pair& pair, std::vector<FixedStay>& stays) {
  Vec3& heel = stays[static_cast<std::size_t>(pair.heel)].place;
  Vec3& ball = stays[static_cast<std::size_t>(pair.ball)].place;
  Vec3 apart = ball - heel;
  const double rise = apart.y();
  if (std::abs(rise) < 0.9 * pair.distance) {
    apart.y() = 0;
    const double level = apart.norm();
    const double wanted = std::sqrt(pair.distance * pair.distance - rise * rise);
    if (level < 1e-9) return;
    apart *= (wanted - level) / level;
  } else {
    apart *= (pair.distance - apart.norm()) / apart.norm();
  }
  heel -= 0.5 * apart;
  ball += 0.5 * apart;
}

// A height with the variance of its error.
struct PlacedHeight {
  Vec3 place;
  double error = 0;  // metres squared
};

// The plane through heights, its slopes held to those of a path that people walk.
struct Plane {
  Vec3 middle = Vec3::Zero();
  Vec3 slope = Vec3::Zero();  // height = slope . (place - middle) + middle.y

  double at(const Vec3& place) const {
    return middle.y() + slope.x() * (place.x() - middle.x()) + slope.z() * (place.z() - middle.z());
  }

  Plane(const std::vector<PlacedHeight>& heights, double spread) {
    constexpr double kSlope = 0.1;
    double sum = 0;
    for (const PlacedHeight& h : heights) {
      middle += h.place / (h.error + spread);
      sum += 1 / (h.error + spread);
    }
    middle /= sum;
    Eigen::Matrix2d moments = Eigen::Matrix2d::Identity() / (kSlope * kSlope);
    Vec2 rises = Vec2::Zero();
    for (const PlacedHeight& h : heights) {
      const Vec2 off(h.place.x() - middle.x(), h.place.z() - middle.z());
      moments += off * off.transpose() / (h.error + spread);
      rises += off * (h.place.y() - middle.y()) / (h.error + spread);
    }
    const Vec2 fitted = moments.inverse() * rises;
    slope = Vec3(fitted.x(), 0, fitted.y());
  }
};

// Moves each height towards the plane, weighted by the variances of its error and of the ground's
// real deviation from the plane (shrinkage, James and Stein 1961). The latter is 0 unless it is
// significant: beyond two deviations of what error alone gives.
std::vector<double> drawn_together(const std::vector<PlacedHeight>& heights) {
  double spread = 0;
  std::vector<double> drawn;
  for (int round = 0; round < 5; ++round) {
    const Plane plane(heights, spread);
    const double freedom = std::max(1.0, static_cast<double>(heights.size()) - 2);
    double off = 0, beyond = 0;
    drawn.clear();
    for (const PlacedHeight& h : heights) {
      const double rest = h.place.y() - plane.at(h.place);
      off += rest * rest / h.error;
      beyond += (rest * rest - h.error) / freedom;
      drawn.push_back(plane.at(h.place) + spread / (spread + h.error) * rest);
    }
    const bool significant = off > freedom + 2 * std::sqrt(2 * freedom);
    spread = significant ? std::max(0.0, beyond) : 0;
  }
  return drawn;
}

class StayFixer {
 public:
  StayFixer(const Clip& clip, const PlantedBody& body, const Leg& leg)
      : clip_(clip), body_(body), leg_(leg) {
    for (const SolePoint& point : leg.points) {
      std::vector<Vec3> track;
      track.reserve(static_cast<std::size_t>(clip.frame_count()));
      for (int f = 0; f < clip.frame_count(); ++f) {
        track.push_back(joint_at(clip, f, point.joint) * point.offset);
      }
      footing.tracks.push_back(std::move(track));
      footing.parts.push_back(point.part);
    }
  }

  // `found`: detected, not given by a person who may have checked it.
  void add(std::size_t point, double start, double end, bool found) {
    const int last_frame = clip_.frame_count() - 1;
    const std::vector<Vec3>& track = footing.tracks[point];
    FixedStay stay;
    stay.point = leg_.points[point];
    stay.first = std::max(0, static_cast<int>(std::ceil(start * clip_.rate - 1e-3)));
    stay.last = std::min(last_frame, static_cast<int>(std::floor(end * clip_.rate + 1e-3)));
    if (stay.first > stay.last) return;
    stay.place = median_place(track, stay.first, stay.last);
    const auto is_far = [&](int f) {
      const Vec3 off = track[static_cast<std::size_t>(f)] - stay.place;
      return off.norm() > kFarFromPlace * body_.leg_length;
    };
    while (stay.first <= stay.last && is_far(stay.first)) ++stay.first;
    while (stay.first <= stay.last && is_far(stay.last)) --stay.last;
    if (stay.first > stay.last) return;
    for (const auto& [from, to] : found ? parts_on_ground(track, stay) : whole(stay)) {
      stay.first = from, stay.last = to;
      stay.place = median_place(track, from, to);
      footing.stays.push_back(stay);
    }
  }

  // By point and frame; stays of a point that overlap become one.
  void order() {
    std::vector<FixedStay>& stays = footing.stays;
    std::ranges::sort(stays, {},
                      [](const FixedStay& s) { return std::pair(s.point.part, s.first); });
    std::vector<FixedStay> apart;
    for (const FixedStay& stay : stays) {
      const bool again = !apart.empty() && apart.back().point.part == stay.point.part &&
                         stay.first <= apart.back().last;
      if (!again) {
        apart.push_back(stay);
      } else if (stay.last > apart.back().last) {
        apart.back().last = stay.last;
        const auto& track = footing.tracks[footing.index_of(stay.point.part)];
        apart.back().place = median_place(track, apart.back().first, stay.last);
      }
    }
    stays = std::move(apart);
    footing.stay_at.assign(leg_.points.size(),
                           std::vector<int>(static_cast<std::size_t>(clip_.frame_count()), -1));
    for (std::size_t i = 0; i < stays.size(); ++i) {
      auto& at = footing.stay_at[footing.index_of(stays[i].point.part)];
      for (int f = stays[i].first; f <= stays[i].last; ++f) {
        at[static_cast<std::size_t>(f)] = static_cast<int>(i);
      }
    }
  }

  // Before stays get their common heights: of each point while it stands.
  void measure_jitter() {
    for (std::size_t p = 0; p < footing.tracks.size(); ++p) {
      KnownCurve heights(footing.tracks[p].size());
      for (std::size_t f = 0; f < footing.tracks[p].size(); ++f) {
        if (footing.stay_at[p][f] >= 0) heights.set(f, Vec3(0, footing.tracks[p][f].y(), 0));
      }
      footing.jitter.push_back(height_jitter_of(heights));
    }
  }

  Footing footing;

 private:
  using Part = std::pair<int, int>;  // frames, inclusive
  static std::vector<Part> whole(const FixedStay& stay) { return {{stay.first, stay.last}}; }

  // The parts of a stay in which the point is not above or below the rest of it: not pressed down
  // before a step, nor held back after.
  std::vector<Part> parts_on_ground(const std::vector<Vec3>& track, FixedStay stay) const {
    const std::vector<Part> still = still_parts(track, stay);
    if (still.size() != 1 || still.front() != Part(stay.first, stay.last)) return still;
    stay.place = median_place(track, stay.first, stay.last);
    const double rise = kOffGround * body_.leg_length + 3 * height_jitter_in(track, stay);
    const int bridged = static_cast<int>(kRisesFor * clip_.rate);
    std::vector<Part> parts;
    for (int f = stay.first; f <= stay.last; ++f) {
      if (std::abs(track[static_cast<std::size_t>(f)].y() - stay.place.y()) > rise) continue;
      if (parts.empty() || f - parts.back().second > bridged + 1) parts.emplace_back(f, f);
      parts.back().second = f;
    }
    return parts;
  }

  // The parts of a stay in which the point does not move, where they are most of it: it has been
  // planted, and the frames between and beside them are of steps. Otherwise the whole.
  std::vector<Part> still_parts(const std::vector<Vec3>& track, const FixedStay& stay) const {
    std::vector<Part> parts;
    int still = 0;
    const auto off = [&](int from, int to) {
      return (track[static_cast<std::size_t>(to)] - track[static_cast<std::size_t>(from)]).norm();
    };
    for (int from = stay.first, to = from; from <= stay.last; from = ++to) {
      while (to < stay.last && off(from, to + 1) <= kStill * body_.leg_length) ++to;
      if (to - from < kFewFrames) continue;
      parts.emplace_back(from, to);
      still += to - from + 1;
    }
    return still < kStillPart * (stay.last - stay.first + 1) ? whole(stay) : parts;
  }

  static double height_jitter_in(const std::vector<Vec3>& track, const FixedStay& stay) {
    KnownCurve heights(static_cast<std::size_t>(stay.last - stay.first + 1));
    for (std::size_t i = 0; i < heights.values.size(); ++i) {
      heights.set(i, track[static_cast<std::size_t>(stay.first) + i]);
    }
    return height_jitter_of(heights);
  }

  const Clip& clip_;
  const PlantedBody& body_;
  const Leg& leg_;
};

void keep_distances(const Leg& leg, Footing& footing) {
  const SolePoint* ball = leg.point(FootPart::ball);
  if (!ball) return;
  const std::size_t b = footing.index_of(FootPart::ball);
  std::vector<Pair> pairs;
  std::vector<double> distances;
  const auto close = [&] {
    if (!distances.empty()) pairs.back().distance = median(std::exchange(distances, {}));
  };
  for (std::size_t f = 0; f < footing.stay_at[0].size(); ++f) {
    const int at_heel = footing.stay_at[0][f], at_ball = footing.stay_at[b][f];
    if (at_heel < 0 || at_ball < 0) continue;
    if (pairs.empty() || pairs.back().heel != at_heel || pairs.back().ball != at_ball) {
      close();
      pairs.push_back({at_heel, at_ball, 0});
    }
    distances.push_back((footing.tracks[b][f] - footing.tracks[0][f]).norm());
  }
  close();
  // Stays overlap as a chain, so that rounds converge.
  double moved = 1;
  for (int round = 0; round < kDistanceRounds && moved > kExact; ++round) {
    moved = 0;
    for (const Pair& pair : pairs) {
      const Vec3 before = footing.stays[static_cast<std::size_t>(pair.heel)].place;
      bring_to_distance(pair, footing.stays);
      moved = std::max(moved,
                       (footing.stays[static_cast<std::size_t>(pair.heel)].place - before).norm());
    }
  }
}

// Draws the heights of one part's stays, of both feet, to the plane that fits them best, as far as
// jitter alone explains their distance from it.
void draw_heights_together(FootPart part, std::vector<Footing>& footings) {
  std::vector<FixedStay*> own;
  std::vector<double> errors, trimmed;  // variances of one frame's height / n; metres
  double apart = 0, expected = 0;
  for (Footing& footing : footings) {
    for (FixedStay& stay : footing.stays) {
      if (stay.point.part != part) continue;
      const std::size_t p = footing.index_of(part);
      const double jitter = footing.jitter[p];
      if (jitter < kJitter) return;
      own.push_back(&stay);
      errors.push_back(jitter * jitter / (stay.last - stay.first + 1));
      trimmed.push_back(trimmed_height(footing.tracks[p], stay.first, stay.last));
      apart += trimmed.back() - stay.place.y();
      expected += kOfDifference * errors.back();
    }
  }
  if (own.size() < 2) return;
  // Feet that jitter up more than down, as at the end of a leg that is straight, have means that
  // are off to one side of the medians.
  const bool even = apart * apart < kUneven * kUneven * expected;
  std::vector<PlacedHeight> heights;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (even) own[i]->place.y() = trimmed[i];
    heights.push_back({own[i]->place, (even ? kOfTrimmed : kOfMedian) * errors[i]});
  }
  const std::vector<double> drawn = drawn_together(heights);
  for (std::size_t i = 0; i < own.size(); ++i) own[i]->place.y() = drawn[i];
}

}  // namespace

std::size_t Footing::index_of(FootPart part) const {
  return static_cast<std::size_t>(std::ranges::find(parts, part) - parts.begin());
}

std::vector<Footing> fix_stays(const Clip& clip, const PlantedBody& body,
                               const std::vector<Stay>& found,
                               const std::vector<PointTrack>& tracks,
                               const std::optional<std::span<const Contact>>& contacts,
                               const std::vector<Footing>& before) {
  std::vector<Footing> footings;
  for (std::size_t i = 0; i < body.legs.size(); ++i) {
    const Leg& leg = body.legs[i];
    StayFixer fixer(clip, body, leg);
    const auto is_named = [](const SolePoint& point) {
      return !point.estimated || point.part == FootPart::heel;
    };
    for (std::size_t p = 0; p < leg.points.size(); ++p) {
      const SolePoint& point = leg.points[p];
      if (contacts && is_named(point)) {
        for (const Contact& contact : *contacts) {
          if (contact.joint == point.joint) fixer.add(p, contact.start, contact.end, false);
        }
        continue;
      }
      for (const Stay& stay : found) {
        const SolePoint& other = tracks[static_cast<std::size_t>(stay.track)].point;
        if (other.side == leg.side && other.part == point.part) {
          fixer.add(p, stay.start, stay.end, true);
        }
      }
    }
    fixer.order();
    fixer.measure_jitter();
    for (std::size_t p = 0; i < before.size() && p < leg.points.size(); ++p) {
      fixer.footing.jitter[p] = std::max(fixer.footing.jitter[p], before[i].jitter[p]);
    }
    footings.push_back(std::move(fixer.footing));
  }
  for (const FootPart part : {FootPart::heel, FootPart::ball, FootPart::tip}) {
    draw_heights_together(part, footings);
  }
  for (std::size_t i = 0; i < footings.size(); ++i) {
    keep_distances(body.legs[i], footings[i]);
  }
  return footings;
}

double drift_of(std::span<const Vec3> track, int first, int last) {
  const auto places =
      track.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first + 1));
  const auto farthest = [&](const Vec3& from) {
    return *std::ranges::max_element(
        places, {}, [&](const Vec3& place) { return (place - from).squaredNorm(); });
  };
  const Vec3 end = farthest(places.front());
  return (farthest(end) - end).norm();
}

}  // namespace krok::plant
