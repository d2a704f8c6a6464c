#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "core/numbers.h"
#include "lint/soles_internal.h"

// foot-slide and drift.

namespace krok::lint {

namespace {

constexpr double kShortestSlide = 0.1;   // seconds
constexpr double kResting = 0.045;       // metres per second; slower is rest
constexpr double kCreeping = 0.2;        // metres per second; faster is a slide or a step
constexpr double kCreepTime = 1;         // seconds
constexpr double kStayTime = 2;          // seconds
constexpr double kMinCreep = 1.35;       // times the threshold of foot-slide
constexpr double kTogether = 0.35;       // difference of two feet's velocities over their size
constexpr double kLift = 0.012;          // metres; a foot that is lifted by more steps
constexpr double kLongestLift = 0.3;     // seconds
constexpr double kShuffle = 0.8;         // metres per second; what is faster for a short time steps
constexpr double kLongestShuffle = 0.4;  // seconds
constexpr double kShownRate = 10;        // frames per second; a step may be between two frames
constexpr double kSettles = 2;           // times slower or faster, of a foot that lands or leaves
constexpr double kUnder = 0.25;          // of the frames, with a foot on the ground
constexpr double kSteady = 0.6;          // of the ground's speed, how far slides differ from it
constexpr double kHipsStay = 0.2;        // of how far feet slide

// Whether a foot is higher for a short time, [first, end) with the fastest frame among it, than
// before and after: a low step.
bool is_lifted(const Series& series, const std::vector<Vec3>& places, int first, int end,
               int fastest) {
  if (end - first > series.frames_in(kLongestLift, 1)) return false;
  const int reach = series.frames_in(kLongestStepEnd, 1);
  const double height = places[at(fastest)].y() - kLift * series.scale;
  const auto is_lower = [&](int from, int to) {
    return std::any_of(&places[at(std::max(0, from))],
                       &places[at(std::min(series.frames - 1, to))] + 1,
                       [&](const Vec3& place) { return place.y() < height; });
  };
  return is_lower(first - reach, fastest) && is_lower(fastest, end - 1 + reach);
}

// Whether a foot that bears, in frames [first, end), still comes down and slows, or goes up already
// and speeds up: it lands or leaves, however slowly.
bool lands_or_leaves(const Series& series, const Soles& soles, int first, int end) {
  const int landing = soles.bearing[at(first)], leaving = soles.bearing[at(end - 1)];
  const auto rise = [&](int track) {
    const auto& places = soles.places[at(track)];
    return (places[at(end - 1)].y() - places[at(first)].y()) / series.scale;
  };
  const double before = soles.speed(landing, first), after = soles.speed(leaving, end - 1);
  return (rise(landing) < -kLift && kSettles * after < before) ||
         (rise(leaving) > kLift && kSettles * before < after);
}

// Level velocity of the ground under who walks in place: that of the feet, if all slide alike and
// the hips stay; otherwise zero.
Vec3 velocity_below(const Series& series, const Soles& soles) {
  Vec3 mean = Vec3::Zero();
  double square = 0;
  int count = 0;
  for (int f = 0; f < series.frames; ++f) {
    const int track = soles.bearing[at(f)];
    if (track < 0) continue;
    mean += soles.slip(track, f), square += soles.slip(track, f).squaredNorm(), ++count;
  }
  if (count < std::max(3.0, kUnder * series.frames)) return Vec3::Zero();
  mean /= count;
  const double speed = mean.norm(), seconds = (series.frames - 1) / series.rate;
  const Vec3f hips = series.clip.frame_positions(series.frames - 1)[at(series.carrier)] -
                     series.clip.frame_positions(0)[at(series.carrier)];
  const bool steady = square / count - speed * speed < kSteady * kSteady * speed * speed;
  const bool stays = level(hips.cast<double>()).norm() < kHipsStay * speed * seconds;
  return steady && stays && speed > kCreeping * series.scale ? mean : Vec3::Zero();
}

// Whether both feet move together, in a third of the frames or more.
bool is_carried(const Soles& soles, int first, int end) {
  int both = 0, together = 0;
  for (int f = first; f < end; ++f) {
    const auto [left, right] = soles.carrying[at(f)];
    if (left < 0 || right < 0) continue;
    const Vec3 a = soles.slip(left, f), b = soles.slip(right, f);
    ++both;
    if ((a - b).norm() < kTogether * std::max(a.norm(), b.norm())) ++together;
  }
  return 3 * both > end - first && together > both / 2;
}

// Frames in which no point of the soles rests, though some are on the ground.
void find_moving(const Series& series, const Soles& soles, std::vector<Finding>& found) {
  const auto moves = [&](int f) {
    const int track = soles.bearing[at(f)];
    return track >= 0 && !(soles.speed(track, f) / series.scale < kResting);
  };
  for (const auto& [first, end] : runs_of(series.frames, moves)) {
    if (end - first < series.frames_in(kShortestSlide, 3)) continue;
    Vec3 way = Vec3::Zero();
    int worst = first;
    const auto speed = [&](int f) { return soles.speed(soles.bearing[at(f)], f); };
    for (int f = first; f < end; ++f) {
      way += soles.slip(soles.bearing[at(f)], f) / series.rate;
      if (speed(f) > speed(worst)) worst = f;
    }
    const Rule rule = is_carried(soles, first, end) ? Rule::drift : Rule::foot_slide;
    Finding finding = finding_of(rule, series, way.norm(), {first, end - 1, worst});
    const int track = soles.bearing[at(worst)];
    // Out of a rest; what is carried away slides from its landing on.
    const bool shuffles = rule == Rule::foot_slide && speed(worst) > kShuffle * series.scale &&
                          first > 0 && soles.bearing[at(first - 1)] >= 0 &&
                          end - first <= series.frames_in(kLongestShuffle, 1);
    if (finding.value <= finding.threshold || shuffles ||
        (rule == Rule::foot_slide && lands_or_leaves(series, soles, first, end)) ||
        is_lifted(series, soles.places[at(track)], first, end, worst)) {
      continue;
    }
    finding.joint = soles.point(track).joint;
    finding.detail = fmt::format("up to {} m/s", readable(speed(worst), 2));
    const auto hips = [&](int f) -> const Vec3f& {
      return series.clip.frame_positions(f)[at(series.carrier)];
    };
    if (level((hips(end - 1) - hips(first)).cast<double>()).norm() < kHipsStay * way.norm()) {
      finding.detail += ", hips stay: --treadmill if the ground moves";
    }
    found.push_back(std::move(finding));
  }
}

// Feet that creep: how far the slowest points of the soles near the ground move within a second,
// from stance to stance, landing and leaving left out. Finds what is too slow for find_moving() and
// too short in each contact for find_stays().
void find_creep(const Series& series, const Soles& soles, std::vector<Finding>& found) {
  const int window = series.frames_in(kCreepTime, 3), margin = series.frames_in(kStepEnd, 1);
  const double limit = kMinCreep * series.threshold(Rule::foot_slide) * series.scale;
  std::vector<Vec3> way(at(series.frames), Vec3::Zero());  // in the frame after
  const auto creeps = [&](int f) {
    const int track = soles.bearing[at(f)];
    return track >= 0 && soles.speed(track, f) < kCreeping * series.scale;
  };
  for (const auto& [first, end] : runs_of(series.frames, creeps)) {
    const int from = first > 0 ? first + margin : 0,
              to = end < series.frames ? end - margin : series.frames;
    for (int f = from; f < to; ++f) {
      way[at(f)] = soles.slip(soles.bearing[at(f)], f) / series.rate;
    }
  }
  std::vector<double> moved(at(series.frames));  // in the second before
  Vec3 sum = Vec3::Zero();
  for (int f = 0; f < series.frames; ++f) {
    sum += way[at(f)];
    if (f >= window) sum -= way[at(f - window)];
    moved[at(f)] = sum.norm();
  }
  int last = -1;  // of what was found
  for (auto [first, end] : runs_of(series.frames, [&](int f) { return moved[at(f)] > limit; })) {
    const auto most = std::max_element(&moved[at(first)], &moved[at(end - 1)] + 1);
    const int from = std::max(0, first - window + 1);
    const int worst = std::max(from, static_cast<int>(most - moved.data()) - window / 2);
    if (last >= 0 && first - last <= window + 1) {
      // Less than a second after the one before.
      Finding& before = found.back();
      before.last = last = end - 1;
      if (*most > before.value) before.value = *most, before.worst = worst;
      continue;
    }
    last = end - 1;
    found.push_back(finding_of(Rule::foot_slide, series, *most, {from, last, worst}));
    found.back().detail = "in a second of stances";
  }
  for (Finding& finding : found) {
    if (finding.joint >= 0) continue;
    finding.joint = soles.point(std::max(0, soles.bearing[at(finding.worst)])).joint;
  }
}

// How far a foot moves in one contact.
void find_stays(const Series& series, const Soles& soles, std::vector<Finding>& found) {
  const double limit = series.threshold(Rule::foot_slide) * series.scale;
  const int window = series.frames_in(kStayTime, 3);
  for (const Stay& stay : soles.found.stays) {
    const SolePoint& point = soles.point(stay.track);
    if (point.part == FootPart::tip) continue;
    // The ends of a contact belong to the step.
    const double margin = std::min(0.06, (stay.end - stay.start) / 4);
    const int first = static_cast<int>(std::ceil((stay.start + margin) * series.rate));
    const int last = std::min(series.frames - 1,
                              static_cast<int>(std::floor((stay.end - margin) * series.rate)));
    if (last - first < 3 || !stands(series, soles, stay.track, (first + last) / 2)) continue;
    const auto moved_between = [&](int from, int to) {
      const auto way_of = [&](const std::vector<Vec3>& of) {
        return level(of[at(to)] - of[at(from)]);
      };
      const Vec3 way = way_of(soles.places[at(stay.track)]);
      Vec3 moved = way;
      for (std::size_t t = 0; t < soles.places.size(); ++t) {
        if (soles.found.tracks[t].point.side != point.side) continue;
        const Vec3 turning = shortest_between(way, way_of(soles.places[t]));
        if (turning.squaredNorm() < moved.squaredNorm()) moved = turning;
      }
      const auto& ankle = soles.ankles[soles.side(stay.track)];
      return (ankle.empty() ? moved : shortest_between(moved, way_of(ankle))).norm();
    };
    double moved = moved_between(first, last);
    if (moved > limit && last - first > window) {  // what takes longer is not seen
      double fastest = 0;
      for (int f = first; f + window <= last; ++f) {
        fastest = std::max(fastest, moved_between(f, f + window));
      }
      moved = std::min(moved, fastest);
    }
    if (moved <= limit) continue;
    Finding finding =
        finding_of(Rule::foot_slide, series, moved, {first, last, (first + last) / 2});
    finding.joint = point.joint;
    finding.detail = fmt::format("{} {} in one contact", name_of(point.side), name_of(point.part));
    found.push_back(std::move(finding));
  }
}

}  // namespace

void find_slides(const Series& series, const Soles& soles, MotionFaults& out) {
  if (series.rate < kShownRate) {
    out.notes.push_back(fmt::format("foot-slide: {} frames per second do not show when feet rest",
                                    readable(series.rate, 3)));
    return;
  }
  std::vector<Finding> found;
  find_moving(series, soles, found);
  find_stays(series, soles, found);
  find_creep(series, soles, found);
  if (soles.found.stays.empty() && series.frames > series.rate) {
    out.notes.emplace_back("foot-slide: no foot rests; --treadmill if the ground moves");
  }
  merge_joints(found, series.frames_in(2 * kLongestStepEnd, 1));
  const Vec3 below = velocity_below(series, soles);
  const auto slides = [](const Finding& one) { return one.rule == Rule::foot_slide; };
  const auto worst = std::ranges::find_if(found, slides);
  if (!below.isZero() && worst != found.end()) {
    // One line for the take, not one for each of its steps.
    Finding whole = *worst;
    for (const Finding& one : found) {
      if (slides(one) && one.value > whole.value) whole = one;
    }
    whole.first = 0, whole.last = series.frames - 1;
    whole.detail = fmt::format("in place, over ground with {} m/s: --treadmill if the ground moves",
                               readable(below.norm(), 2));
    found.assign(1, whole);
  }
  out.findings.insert(out.findings.end(), found.begin(), found.end());
}

}  // namespace krok::lint
