#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "contacts/contacts.h"
#include "core/index.h"
#include "core/numbers.h"
#include "lint/series_internal.h"

// foot-slide, drift and ground.

namespace krok::lint {

namespace {

constexpr double kNear = 0.03;            // metres above the support, of points that may carry
constexpr double kRising = 0.25;          // metres per second; faster up or down is a step
constexpr double kFastest = 1.7;          // metres per second; faster is a swing, not a slide
constexpr double kSpeedTime = 0.07;       // seconds over which speeds are measured
constexpr double kShortestSlide = 0.1;    // seconds
constexpr double kStepEnd = 0.06;         // seconds in which a foot lands or leaves, at least
constexpr double kLongestStepEnd = 0.15;  // the same, while it is much faster than at its slowest
constexpr double kStepFactor = 2;         // times the slowest speed
constexpr double kStepSpeed = 0.1;        // metres per second, added to it
constexpr double kResting = 0.045;        // metres per second; slower is rest
constexpr double kCreeping = 0.2;         // metres per second; faster is a slide or a step
constexpr double kCreepTime = 1;          // seconds
constexpr double kStayTime = 2;           // seconds
constexpr double kSoftTip = 0.5;          // of the threshold, that tips of toes may be deeper
constexpr double kMinCreep = 1.35;        // times the threshold of foot-slide
constexpr double kTogether = 0.35;        // difference of two feet's velocities over their size
constexpr double kStanding = 0.45;        // of the legs' length, of hips over a foot that carries
constexpr double kKnees = 0.85;           // of the same; less is a bent leg
constexpr double kLean = 0.7;             // of a bent leg's height, its length along the ground
constexpr double kOffFloor = 0.1;         // metres over the lowest contact
constexpr double kLift = 0.012;           // metres; a foot that is lifted by more steps
constexpr double kLongestLift = 0.3;      // seconds
constexpr double kSeldom = 0.1;           // of the time; feet that stand for less show no ground
constexpr double kUneven = 0.1;           // metres, of heights of contacts on level ground
constexpr double kFloor = 2;              // times the threshold, of the floor's height
constexpr double kUpright = 0.8;          // of the legs' length, height of the hips
constexpr double kShortestHover = 0.25;   // seconds
constexpr double kShortestSink = 0.05;    // seconds; what is shorter is a pop
constexpr double kMinFall = 4;            // metres per second squared

// The feet's points over the frames.
struct Soles {
  FoundContacts found;
  std::vector<std::vector<Vec3>> places;      // [tracks][frames], metres
  std::vector<std::vector<Vec3>> velocities;  // [tracks][frames], metres per second, level
  std::vector<std::vector<double>> rises;     // the same, upwards
  double floor = INFINITY;                    // height of the lowest contact, metres
  // [frames][FootSide], the slowest point of each foot that is near the ground, -1 for a foot in
  // the air.
  std::vector<std::array<int, 2>> carrying;
  std::vector<std::array<int, 2>> standing;  // the same, -1 also where the foot lands or leaves
  // [frames][FootSide], metres per second: that of the slowest place between the carrying point and
  // the foot's others, about which the foot turns.
  std::vector<std::array<Vec3, 2>> slips;
  // [FootSide][frames], of feet whose points are all estimated, from where their joint turns to:
  // the joint, which rests where the foot does. Otherwise empty.
  std::array<std::vector<Vec3>, 2> ankles, ankle_velocities;

  std::size_t side(int track) const {
    return static_cast<std::size_t>(found.tracks[at(track)].point.side);
  }
  const Vec3& slip(int track, int frame) const { return slips[at(frame)][side(track)]; }
  double speed(int track, int frame) const { return slip(track, frame).norm(); }
  bool stays(int track, int frame) const {
    return track >= 0 && standing[at(frame)][side(track)] >= 0;
  }
  // The slower of two feet, -1 for none.
  int slower(const std::array<int, 2>& feet, int frame) const {
    if (feet[0] < 0 || feet[1] < 0) return std::max(feet[0], feet[1]);
    return speed(feet[1], frame) < speed(feet[0], frame) ? feet[1] : feet[0];
  }
};

std::vector<Vec3> velocities_of(const std::vector<Vec3>& places, double rate, double seconds) {
  const int frames = static_cast<int>(places.size());
  const int reach = std::max(1, static_cast<int>(std::lround(seconds * rate / 2)));
  std::vector<Vec3> velocities(places.size());
  for (int f = 0; f < frames; ++f) {
    const int a = std::max(0, f - reach), b = std::min(frames - 1, f + reach);
    const Vec3 moved = places[at(b)] - places[at(a)];
    velocities[at(f)] = b > a ? Vec3(moved * (rate / (b - a))) : Vec3::Zero();
  }
  return velocities;
}

// Whether the body stands on a foot; not of who sits, with feet on the floor or above it, crawls or
// lies.
bool stands(const Series& series, const Soles& soles, int track, int frame) {
  const Vec3 hips = series.clip.frame_positions(frame)[at(series.carrier)].cast<double>();
  const Vec3 leg = hips - soles.places[at(track)][at(frame)];
  if (leg.y() < kStanding * soles.found.leg_length) return false;
  if (leg.y() > kKnees * soles.found.leg_length) return true;
  return std::hypot(leg.x(), leg.z()) < kLean * leg.y() &&
         hips.y() - leg.y() < soles.floor + kOffFloor * series.scale;
}

// The shortest of the vectors from `a` to `b`: the movement of the place of a foot about which it
// turns, if its ends move by these. At most `part` of the way to `b`.
Vec3 shortest_between(const Vec3& a, const Vec3& b, double part = 1) {
  const Vec3 way = b - a;
  const double square = way.squaredNorm();
  return square > 0 ? Vec3(a + std::clamp(-a.dot(way) / square, 0.0, part) * way) : a;
}

// How much of the way from a point to one that is higher is near the support.
double low_part(double height, double other, double limit) {
  return other <= limit ? 1 : std::clamp((limit - height) / (other - height), 0.0, 1.0);
}

std::array<int, 2> carrying(const Series& series, Soles& soles, int frame) {
  std::array<int, 2> slowest = {-1, -1};
  const double near = kNear * series.scale;
  const auto velocity = [&](int track) -> const Vec3& {
    return soles.velocities[at(track)][at(frame)];
  };
  for (int t = 0; t < static_cast<int>(soles.places.size()); ++t) {
    const PointTrack& track = soles.found.tracks[at(t)];
    if (track.height[at(frame)] > near ||
        std::abs(soles.rises[at(t)][at(frame)]) > kRising * series.scale ||
        velocity(t).norm() > kFastest * series.scale || !stands(series, soles, t, frame)) {
      continue;
    }
    int& best = slowest[soles.side(t)];
    if (best < 0 || velocity(t).norm() < velocity(best).norm()) best = t;
  }
  for (const int best : slowest) {
    if (best < 0) continue;
    Vec3& slip = soles.slips[at(frame)][soles.side(best)] = velocity(best);
    for (int t = 0; t < static_cast<int>(soles.places.size()); ++t) {
      if (soles.side(t) != soles.side(best)) continue;
      const double part = low_part(soles.found.tracks[at(best)].height[at(frame)],
                                   soles.found.tracks[at(t)].height[at(frame)], near);
      const Vec3 turning = shortest_between(velocity(best), velocity(t), part);
      if (turning.squaredNorm() < slip.squaredNorm()) slip = turning;
    }
    const auto& of_ankle = soles.ankle_velocities[soles.side(best)];
    if (!of_ankle.empty()) slip = shortest_between(slip, of_ankle[at(frame)]);
  }
  return slowest;
}

// Takes out the beginning and end of each stance of a foot, in which it still slows down or already
// speeds up.
void take_out_step_ends(const Series& series, std::size_t side, Soles& soles) {
  const int shortest = series.frames_in(kStepEnd, 1),
            longest = series.frames_in(kLongestStepEnd, shortest);
  const auto foot = [&](int f) { return soles.carrying[at(f)][side]; };
  for (int first = 0, end = 0; first < series.frames; first = end + 1) {
    for (end = first; end < series.frames && foot(end) >= 0;) ++end;
    for (const int step : {1, -1}) {
      if (end == first || (step > 0 ? first == 0 : end == series.frames)) continue;
      const int begin = step > 0 ? first : end - 1, count = std::min(longest, end - first);
      const auto speed = [&](int k) {
        const int f = begin + step * k;
        return soles.speed(foot(f), f);
      };
      int slowest = 0, ends = std::min(shortest, count);
      for (int k = 1; k < count; ++k) slowest = speed(k) < speed(slowest) ? k : slowest;
      const double limit = kStepFactor * speed(slowest) + kStepSpeed * series.scale;
      for (int k = ends; k < slowest; ++k) ends = speed(k) > limit ? k + 1 : ends;
      for (int k = 0; k < ends; ++k) soles.standing[at(begin + step * k)][side] = -1;
    }
  }
}

// A point of each foot none of whose points a joint marks.
std::vector<SolePoint> unmarked_feet(std::span<const PointTrack> tracks) {
  std::vector<SolePoint> feet;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    const auto is_of = [&](const PointTrack& track) { return track.point.side == side; };
    const auto is_marked = [&](const PointTrack& track) {
      return is_of(track) && !track.point.estimated;
    };
    const auto first = std::ranges::find_if(tracks, is_of);
    if (first != tracks.end() && std::ranges::none_of(tracks, is_marked)) {
      feet.push_back(first->point);
    }
  }
  return feet;
}

std::optional<Soles> soles_of(const Series& series) {
  auto found = find_contacts(series.clip, series.roles);
  if (!found) return std::nullopt;
  Soles soles;
  soles.found = *std::move(found);
  for (const PointTrack& track : soles.found.tracks) {
    soles.places.push_back(track_of(series.clip, track.point, soles.found.leg_length));
    std::vector<Vec3> velocities = velocities_of(soles.places.back(), series.rate, kSpeedTime);
    std::vector<double>& rises = soles.rises.emplace_back();
    for (Vec3& velocity : velocities) {
      rises.push_back(velocity.y());
      velocity.y() = 0;
    }
    soles.velocities.push_back(std::move(velocities));
  }
  for (const SolePoint& point : unmarked_feet(soles.found.tracks)) {
    const auto side = static_cast<std::size_t>(point.side);
    soles.ankles[side] =
        track_of(series.clip, {point.side, point.part, point.joint}, soles.found.leg_length);
    soles.ankle_velocities[side] = velocities_of(soles.ankles[side], series.rate, kSpeedTime);
    for (Vec3& velocity : soles.ankle_velocities[side]) velocity.y() = 0;
  }
  for (const Stay& stay : soles.found.stays) {
    soles.floor = std::min(soles.floor, stay.place.y());
  }
  soles.slips.assign(at(series.frames), {Vec3::Zero(), Vec3::Zero()});
  for (int f = 0; f < series.frames; ++f) soles.carrying.push_back(carrying(series, soles, f));
  soles.standing = soles.carrying;
  for (const std::size_t side : {0, 1}) take_out_step_ends(series, side, soles);
  return soles;
}

// Runs of frames in which no point of the soles rests, though some are on the ground.
class Slides {
 public:
  Slides(const Series& series, const Soles& soles, std::vector<Finding>& found)
      : series_(series), soles_(soles), found_(found) {}

  void find() {
    for (int f = 0; f < series_.frames; ++f) {
      const int slowest = soles_.slower(soles_.carrying[at(f)], f);
      const double speed = slowest < 0 ? 0 : soles_.speed(slowest, f) / series_.scale;
      if (!soles_.stays(slowest, f) || speed < kResting) {
        end();
        continue;
      }
      frames_.emplace_back(f, slowest);
      const auto [left, right] = soles_.carrying[at(f)];
      if (left >= 0 && right >= 0) {
        const Vec3 a = soles_.slip(left, f), b = soles_.slip(right, f);
        ++both_;
        if ((a - b).norm() < kTogether * std::max(a.norm(), b.norm())) ++together_;
      }
    }
    end();
  }

 private:
  // Whether the foot is higher for a short time, `frame`, at which it is fastest, among it, than
  // before and after: a low step.
  bool is_lifted(int frame) const {
    if (static_cast<int>(frames_.size()) > series_.frames_in(kLongestLift, 1)) return false;
    const auto place = std::ranges::find(frames_, frame, &std::pair<int, int>::first);
    const auto& places = soles_.places[at(place->second)];
    const int reach = series_.frames_in(kLongestStepEnd, 1);
    const double height = places[at(frame)].y() - kLift * series_.scale;
    const auto is_lower = [&](int first, int last) {
      for (int f = std::max(0, first); f <= std::min(series_.frames - 1, last); ++f) {
        if (places[at(f)].y() < height) return true;
      }
      return false;
    };
    return is_lower(frames_.front().first - reach, frame) &&
           is_lower(frame, frames_.back().first + reach);
  }
  // Whether the hips hardly move while feet slide, as in a motion in place.
  bool hips_stay(int first, int last, const Vec3& slid) const {
    Vec3f way = series_.clip.frame_positions(last)[at(series_.carrier)] -
                series_.clip.frame_positions(first)[at(series_.carrier)];
    way.y() = 0;
    return way.norm() < 0.2 * slid.norm();
  }
  void end() {
    if (static_cast<int>(frames_.size()) >= series_.frames_in(kShortestSlide, 3)) {
      Finding finding;
      finding.first = frames_.front().first, finding.last = frames_.back().first;
      Vec3 way = Vec3::Zero();
      double fastest = 0;
      for (const auto& [f, track] : frames_) {
        way += soles_.slip(track, f) / series_.rate;
        if (soles_.speed(track, f) <= fastest) continue;
        fastest = soles_.speed(track, f), finding.worst = f;
        finding.joint = soles_.found.tracks[at(track)].point.joint;
      }
      const bool body = 3 * both_ > static_cast<int>(frames_.size()) && together_ > both_ / 2;
      finding.rule = body ? Rule::drift : Rule::foot_slide;
      finding.value = way.norm();
      finding.threshold = series_.threshold(finding.rule) * series_.scale, finding.unit = "m";
      finding.detail = fmt::format("up to {} m/s", readable(fastest, 2));
      if (hips_stay(finding.first, finding.last, way)) {
        finding.detail += ", hips stay: --treadmill if the ground moves";
      }
      if (finding.value > finding.threshold && !is_lifted(finding.worst)) found_.push_back(finding);
    }
    frames_.clear();
    both_ = together_ = 0;
  }

  const Series& series_;
  const Soles& soles_;
  std::vector<Finding>& found_;
  std::vector<std::pair<int, int>> frames_;  // of a slide, with the slowest point
  int both_ = 0, together_ = 0;
};

// Feet that creep: how far the slowest points of the soles near the ground move within a second,
// from stance to stance, landing and leaving left out. Finds what is too slow for Slides and too
// short in each contact for find_stays().
void find_creep(const Series& series, const Soles& soles, std::vector<Finding>& found) {
  const int window = series.frames_in(kCreepTime, 3), margin = series.frames_in(kStepEnd, 1);
  std::vector<Vec3> way(at(series.frames), Vec3::Zero());  // in the frame after
  std::vector<int> slowest(at(series.frames), -1);
  int nearest_step = -margin - 1;
  for (int f = 0; f < series.frames; ++f) {
    const int track = soles.slower(soles.carrying[at(f)], f);
    if (soles.stays(track, f) && soles.speed(track, f) < kCreeping * series.scale) {
      slowest[at(f)] = track, way[at(f)] = soles.slip(track, f) / series.rate;
    } else {
      nearest_step = f;
      for (int g = std::max(0, f - margin); g < f; ++g) way[at(g)].setZero();
    }
    if (f - nearest_step <= margin) way[at(f)].setZero();
  }
  Vec3 sum = Vec3::Zero();
  Finding finding;
  for (int f = 0; f <= series.frames; ++f) {
    if (f < series.frames) sum += way[at(f)];
    if (f >= window) sum -= way[at(f - window)];
    const double moved = f < series.frames ? sum.norm() : 0;
    if (moved > kMinCreep * series.threshold(Rule::foot_slide) * series.scale) {
      if (finding.value == 0) finding.first = std::max(0, f - window + 1);
      finding.last = f;
      if (moved > finding.value) finding.value = moved, finding.worst = f - window / 2;
    } else if (finding.value > 0 && (f - finding.last > window || f == series.frames)) {
      finding.rule = Rule::foot_slide;
      finding.worst = std::max(finding.first, finding.worst);
      const int point = std::max(0, slowest[at(finding.worst)]);
      finding.joint = soles.found.tracks[at(point)].point.joint;
      finding.threshold = series.threshold(Rule::foot_slide) * series.scale, finding.unit = "m";
      finding.detail = "in a second of stances";
      found.push_back(finding);
      finding = {};
    }
  }
}

// How far a foot moves in one contact.
void find_stays(const Series& series, const Soles& soles, std::vector<Finding>& found) {
  const double limit = series.threshold(Rule::foot_slide) * series.scale;
  const int window = series.frames_in(kStayTime, 3);
  for (const Stay& stay : soles.found.stays) {
    const PointTrack& track = soles.found.tracks[at(stay.track)];
    if (track.point.part == FootPart::tip) continue;
    const auto& places = soles.places[at(stay.track)];
    // The ends of a contact belong to the step.
    const double margin = std::min(0.06, (stay.end - stay.start) / 4);
    const int first = static_cast<int>(std::ceil((stay.start + margin) * series.rate));
    const int last = std::min(series.frames - 1,
                              static_cast<int>(std::floor((stay.end - margin) * series.rate)));
    if (last - first < 3 || !stands(series, soles, stay.track, (first + last) / 2)) continue;
    const auto moved_between = [&](int from, int to) {
      const auto level_way = [&](const std::vector<Vec3>& of) -> Vec3 {
        const Vec3 way = of[at(to)] - of[at(from)];
        return {way.x(), 0, way.z()};
      };
      const Vec3 way = level_way(places);
      Vec3 moved = way;
      for (std::size_t t = 0; t < soles.places.size(); ++t) {
        if (soles.found.tracks[t].point.side != track.point.side) continue;
        const Vec3 turning = shortest_between(way, level_way(soles.places[t]));
        if (turning.squaredNorm() < moved.squaredNorm()) moved = turning;
      }
      const auto& ankle = soles.ankles[soles.side(stay.track)];
      return (ankle.empty() ? moved : shortest_between(moved, level_way(ankle))).norm();
    };
    double moved = moved_between(first, last);
    if (moved > limit && last - first > window) {  // what takes longer is not seen
      double fastest = 0;
      for (int f = first; f + window <= last; ++f) {
        fastest = std::max(fastest, moved_between(f, f + window));
      }
      moved = std::min(moved, fastest);
    }
    Finding finding;
    finding.rule = Rule::foot_slide;
    finding.joint = track.point.joint;
    finding.first = first, finding.last = last, finding.worst = (first + last) / 2;
    finding.value = moved;
    finding.threshold = limit, finding.unit = "m";
    finding.detail =
        fmt::format("{} {} in one contact", name_of(track.point.side), name_of(track.point.part));
    if (finding.value > finding.threshold) found.push_back(finding);
  }
}

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
  Level level;
  if (total <= 0) return level;
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
      if (soles.found.tracks[at(t)].point.part == FootPart::tip) lower_.back() += kSoftTip * limit_;
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
      if (std::abs(level_.height) > kFloor * limit_)
        add("floor", 0, series_.frames - 1, 0, std::abs(level_.height), kFloor * limit_);
    }
    find_sinking();
    find_hovering();
  }

 private:
  std::optional<double> ground_at(const Vec3& point) const {
    return series_.options.ground ? series_.options.ground(point) : level_.height;
  }

  void add(const char* kind, int first, int last, int worst, double value, double limit,
           int joint = -1) {
    Finding finding;
    finding.rule = Rule::ground;
    finding.kind = kind;
    finding.joint = joint;
    finding.first = first, finding.last = last, finding.worst = worst;
    finding.value = value, finding.threshold = limit, finding.unit = "m";
    out_.findings.push_back(finding);
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

  void find_sinking() {
    double deepest = 0;
    int first = 0, worst = 0, joint = -1, frames = 0;
    for (int f = 0; f <= series_.frames; ++f) {
      double deep = 0;
      int here = -1;
      for (std::size_t t = 0; f < series_.frames && t < soles_.places.size(); ++t) {
        if (marked_ && soles_.found.tracks[t].point.estimated) continue;
        const Vec3& place = soles_.places[t][at(f)];
        const auto ground = ground_at(place);
        if (!ground || *ground - lower_[t] - place.y() <= deep) continue;
        double depth = depth_of(place, *ground - lower_[t]);
        const std::size_t side = soles_.side(static_cast<int>(t));
        if (!series_.options.ground && !soles_.ankles[side].empty()) {
          depth = std::min(depth, ankle_levels_[side] - soles_.ankles[side][at(f)].y());
        }
        if (depth > deep) deep = depth, here = soles_.found.tracks[t].point.joint;
      }
      if (deep > limit_) {
        if (frames++ == 0) first = f;
        if (deep > deepest) deepest = deep, worst = f, joint = here;
      } else if (frames > 0) {
        if (frames >= series_.frames_in(kShortestSink, 2))
          add("sinking", first, f - 1, worst, deepest, limit_, joint);
        frames = 0, deepest = 0;
      }
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
    const int shortest = series_.frames_in(kShortestHover, 4);
    int first = -1, worst = 0;
    double highest = 0;
    for (int f = 0; f <= series_.frames; ++f) {
      double over = 0;
      if (f < series_.frames) {
        over = clearance(f);
        const Vec3 hips = series_.clip.frame_positions(f)[at(series_.carrier)].cast<double>();
        const auto ground = ground_at(hips);
        if (!ground || hips.y() - *ground < kUpright * soles_.found.leg_length) over = 0;
      }
      if (over > limit_ && std::isfinite(over)) {
        if (first < 0) first = f;
        if (over > highest) highest = over, worst = f;
      } else if (first >= 0) {
        if (f - first >= shortest && series_.fall(first, f - 1) < kMinFall &&
            series_.fall(first, f - 1, true) < kMinFall) {
          add("hovering", first, f - 1, worst, highest, limit_);
        }
        first = -1, highest = 0;
      }
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

void find_foot_faults(const Series& series, MotionFaults& out) {
  const bool slides = series.has(Rule::foot_slide) || series.has(Rule::drift);
  if (!slides && !series.has(Rule::ground)) return;
  const auto soles = soles_of(series);
  if (!soles) return;
  std::vector<Finding> found;
  if (slides && !series.options.treadmill) {
    Slides(series, *soles, found).find();
    find_stays(series, *soles, found);
    find_creep(series, *soles, found);
    if (soles->found.stays.empty() && series.frames > series.rate) {
      out.notes.emplace_back("foot-slide: no foot rests; --treadmill if the ground moves");
    }
  }
  merge_joints(found, series.frames_in(2 * kLongestStepEnd, 1));
  out.findings.insert(out.findings.end(), found.begin(), found.end());
  if (series.has(Rule::ground)) GroundRule(series, *soles, out).find();
}

}  // namespace krok::lint
