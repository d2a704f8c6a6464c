#include <algorithm>
#include <cmath>
#include <numeric>

#include "contacts/series_internal.h"
#include "contacts/walking_feet_internal.h"
#include "motion/hips_root.h"

namespace krok::contacts {

namespace {

constexpr double kSeedCutoff = 6;      // Hz
constexpr double kTravelCutoff = 0.6;  // Hz
constexpr double kTravelSpeed = 0.3;   // metres per second
constexpr double kGap = 0.1;           // seconds
constexpr double kJitter = 0.001;      // metres, frame to frame
constexpr double kSlowing = 0.08;      // seconds
constexpr double kSettling = 0.03;     // seconds
constexpr double kRest = 0.15;         // metres per second
constexpr double kJitterTimes = 2;
constexpr double kSpeedCutoff = 15;  // Hz, of the tracks' speeds
constexpr double kTogether = 0.06;   // seconds
constexpr double kWindow = 0.12;     // seconds, on either side of a break
constexpr double kJitteryWindow = 0.18;
constexpr double kHeelUp = 0.02;    // metres above its support
constexpr double kForward = 0.7;    // cosine between travel and facing
constexpr double kEnd = 0.12;       // seconds at a clip's ends
constexpr double kEndMovement = 2;  // metres per second squared: half a slow landing's deceleration

double level_norm(const Vec3& v) {
  return std::hypot(v.x(), v.z());
}

class FootSteps {
 public:
  FootSteps(const FoundContacts& found, FootSide side) {
    for (const Stay& stay : found.stays) {
      const SolePoint& point = found.tracks[static_cast<std::size_t>(stay.track)].point;
      if (point.side == side)
        stays_.push_back({stay.start, stay.end, stay.open_start, stay.open_end, false});
    }
    std::ranges::stable_sort(stays_, {}, &Stance::start);
  }

  // Merges the stays of the foot's points to stances, closing gaps that are not steps.
  template <typename IsStep>
  void join(const IsStep& is_step) {
    for (const Stance& stay : stays_) {
      if (stances.empty() ||
          (stay.start - stances.back().end > kGap && is_step(stances.back().end, stay.start))) {
        stances.push_back(stay);
        continue;
      }
      Stance& last = stances.back();
      last.open_start = last.open_start || stay.open_start;
      if (stay.end > last.end) {
        last.end = stay.end;
        last.open_end = stay.open_end;
      }
    }
  }

  std::vector<Stance> stances;

 private:
  std::vector<Stance> stays_;
};

// The fractional frame at which the speed crosses `slow` between a slow frame and its neighbour.
template <typename Speed>
double crossed(const Speed& speed, int slow_frame, int fast_frame, int frames, double slow) {
  if (fast_frame < 0 || fast_frame >= frames) return slow_frame;
  const double part =
      (slow - speed(slow_frame)) / std::max(1e-9, speed(fast_frame) - speed(slow_frame));
  return slow_frame + part * (fast_frame - slow_frame);
}

}  // namespace

WalkingFeet::WalkingFeet(const Clip& clip, const RoleMap& roles, const FoundContacts& found,
                         const GaitOptions& options)
    : clip_(clip), found_(found), options_(options), leg_(found.leg_length) {
  carrier_ = carrying_joint(roles);
  const SolePoint carrier{FootSide::left, FootPart::heel, carrier_, Vec3::Zero(), false};
  pelvis_ = smoothed(track_of(clip, carrier, leg_), clip.rate, kSeedCutoff);
  for (std::size_t t = 0; t < found.tracks.size(); ++t) {
    const SolePoint& point = found.tracks[t].point;
    raw_.push_back(track_of(clip, point, leg_));
    tracks_.push_back(smoothed(raw_.back(), clip.rate, kSeedCutoff));
    jitters_.push_back(jitter_of(raw_.back()));
    jittery_ = jittery_ || jitters_.back() > kJitter * leg_ / kUsualLeg;
    feet_[static_cast<std::size_t>(point.side)].tracks.push_back(t);
  }
  take_directions();
  for (const FootSide side : {FootSide::left, FootSide::right}) prepare(side);
  find_carriage();
  for (Foot& foot : feet_) to_landings(foot);
}

double WalkingFeet::jitter() const {
  return jitters_.empty() ? 0 : std::ranges::max(jitters_);
}

void WalkingFeet::take_directions() {
  std::vector<Vec3> slow = velocities(pelvis_, clip_.rate);
  slow = smoothed(slow, clip_.rate, kTravelCutoff);
  for (int f = 0; f < clip_.frame_count(); ++f) {
    const Vec3& v = slow[static_cast<std::size_t>(f)];
    const double speed = level_norm(v);
    const double heading = ground_frame(clip_, carrier_, f).heading;
    const Vec3 facing(std::sin(heading), 0, std::cos(heading));
    const bool travels = speed > kTravelSpeed * leg_ / kUsualLeg;
    directions_.push_back(travels ? Vec3(v.x() / speed, 0, v.z() / speed) : facing);
    speeds_.push_back(speed);
    const double ahead = directions_.back().dot(facing);
    forward_.push_back(ahead > kForward ? 1 : ahead < -kForward ? -1 : 0);
  }
}

void WalkingFeet::prepare(FootSide side) {
  Foot& foot = feet_[static_cast<std::size_t>(side)];
  if (foot.tracks.empty()) return;
  const auto &heel = tracks_[foot.tracks.front()], &front = tracks_[foot.tracks.back()];
  std::vector<double> reach;
  for (std::size_t f = 0; f < pelvis_.size(); ++f) {
    reach.push_back(directions_[f].dot(0.5 * (heel[f] + front[f]) - pelvis_[f]));
  }
  foot.seeds = turning_points(reach, clip_.rate, options_.least_reach * leg_);
  foot.cycle = cycle_of(foot.seeds);
  FootSteps steps(found_, side);
  steps.join([&](double from, double to) { return is_step(foot, from, to); });
  foot.stances = std::move(steps.stances);
  add_sliding(foot);
  open_ends(foot);
  for (std::size_t i = 0; i < foot.stances.size(); ++i) {
    const double before = i == 0 ? -1 : foot.stances[i - 1].end;  // -1: frame 0 is looked at, too
    const double after =
        i + 1 == foot.stances.size() ? clip_.duration() : foot.stances[i + 1].start;
    to_touches(foot, before, after, foot.stances[i]);
  }
}

void WalkingFeet::add_sliding(Foot& foot) const {
  for (const double front : foot.seeds.front) {
    const auto back = std::ranges::upper_bound(foot.seeds.back, front);
    if (back == foot.seeds.back.end() || *back - front > foot.cycle) continue;
    const bool known = std::ranges::any_of(foot.stances, [&](const Stance& stance) {
      return stance.start < *back && front < stance.end;
    });
    if (known) continue;
    if (const auto stance = sliding(foot, front, *back)) foot.stances.push_back(*stance);
  }
  std::ranges::sort(foot.stances, {}, &Stance::start);
}

double WalkingFeet::lowest_of(const Foot& foot, std::size_t f) const {
  double least = 1e9;
  for (const std::size_t t : foot.tracks) least = std::min(least, tracks_[t][f].y());
  return least;
}

double WalkingFeet::floor_near(int frame, double cycle) const {
  const int reach = static_cast<int>(cycle * clip_.rate);
  double least = 1e9;
  for (int f = std::max(0, frame - reach); f <= std::min(clip_.frame_count() - 1, frame + reach);
       ++f) {
    for (const Foot& foot : feet_) {
      least = std::min(least, lowest_of(foot, static_cast<std::size_t>(f)));
    }
  }
  return least;
}

bool WalkingFeet::is_low(const Foot& foot, int frame, double floor) const {
  return lowest_of(foot, static_cast<std::size_t>(frame)) - floor <
         options_.low_height * leg_ / kUsualLeg;
}

bool WalkingFeet::stays_low(const Foot& foot, double seed, bool front) const {
  // Without another seed within a cycle: a cycle away, within the clip.
  double other =
      front ? std::min(clip_.duration(), seed + foot.cycle) : std::max(0.0, seed - foot.cycle);
  for (const double time : front ? foot.seeds.back : foot.seeds.front) {
    if (front ? time > seed && time < other : time < seed && time > other) other = time;
  }
  const int from = static_cast<int>(std::min(seed, other) * clip_.rate);
  const int to =
      std::min(clip_.frame_count() - 1, static_cast<int>(std::max(seed, other) * clip_.rate));
  const double floor = floor_near((from + to) / 2, foot.cycle);
  int low = 0;
  for (int f = from; f <= to; ++f) low += is_low(foot, f, floor) ? 1 : 0;
  return low >= 0.75 * (to - from + 1);
}

bool WalkingFeet::has_tip(const Foot& foot) const {
  return std::ranges::any_of(
      foot.tracks, [&](std::size_t t) { return found_.tracks[t].point.part == FootPart::tip; });
}

std::size_t WalkingFeet::frame_at(double time) const {
  return static_cast<std::size_t>(
      std::clamp<double>(std::lround(time * clip_.rate), 0, clip_.frame_count() - 1));
}

bool WalkingFeet::moves(const Foot& foot, double from, double to) const {
  return std::ranges::all_of(foot.tracks, [&](std::size_t t) {
    return (tracks_[t][frame_at(from)] - tracks_[t][frame_at(to)]).norm() >
           options_.least_way * leg_ / kUsualLeg;
  });
}

void WalkingFeet::open_ends(Foot& foot) const {
  if (foot.stances.empty()) return;
  const auto stays = [&](double from, double to) {
    const double least = kEndMovement * (to - from) * (to - from) * leg_ / kUsualLeg;
    return std::ranges::any_of(foot.tracks, [&](std::size_t t) {
      const double moved = (raw_[t][frame_at(from)] - raw_[t][frame_at(to)]).norm();
      return moved < least + 2 * jitters_[t];
    });
  };
  Stance &first = foot.stances.front(), &last = foot.stances.back();
  if (!first.open_start && first.start < kEnd && stays(0, first.start)) {
    first.start = 0;
    first.open_start = true;
  }
  if (!last.open_end && last.end > clip_.duration() - kEnd && stays(last.end, clip_.duration())) {
    last.end = clip_.duration();
    last.open_end = true;
  }
}

double WalkingFeet::slowest_of(const Foot& foot, int frame) const {
  double least = 1e9;
  for (const std::size_t t : foot.tracks) {
    least = std::min(least, found_.tracks[t].speed[static_cast<std::size_t>(frame)]);
  }
  return least;
}

std::optional<Stance> WalkingFeet::sliding(const Foot& foot, double front, double back) const {
  const int frames = clip_.frame_count();
  const auto slowest = [&](int frame) { return slowest_of(foot, frame); };
  double fastest = 0;
  const int reach = static_cast<int>(foot.cycle * clip_.rate);
  const int from = static_cast<int>(front * clip_.rate), to = static_cast<int>(back * clip_.rate);
  for (int f = std::max(0, from - reach); f < std::min(frames, to + reach); ++f) {
    fastest = std::max(fastest, slowest(f));
  }
  int calm = from;
  for (int f = from; f <= std::min(to, frames - 1); ++f) {
    if (slowest(f) < slowest(calm)) calm = f;
  }
  const double slow = options_.sliding_speed * fastest;
  if (slowest(calm) > 0.5 * slow) return {};
  if (!is_low(foot, calm, floor_near(calm, foot.cycle))) return {};
  int first = calm, last = calm;
  while (first > 0 && slowest(first - 1) <= slow) --first;
  while (last + 1 < frames && slowest(last + 1) <= slow) ++last;
  return Stance{crossed(slowest, first, first - 1, frames, slow) / clip_.rate,
                crossed(slowest, last, last + 1, frames, slow) / clip_.rate, first == 0,
                last == frames - 1, true};
}

void WalkingFeet::to_touches(const Foot& foot, double before, double after, Stance& stance) const {
  if (stance.slides) return;
  std::vector<double> starts;
  double end = stance.end;
  for (const std::size_t t : foot.tracks) {
    std::optional<double> start;
    // Stays are by track and start.
    auto place =
        std::ranges::lower_bound(found_.stays, std::pair(static_cast<int>(t), stance.start - 1e-9),
                                 {}, [](const Stay& s) { return std::pair(s.track, s.start); });
    for (; place != found_.stays.end() && place->track == static_cast<int>(t); ++place) {
      const Stay& stay = *place;
      if (stay.start > stance.end + 1e-9) break;
      if (stay.end > stance.end + 1e-9) continue;
      if (!stance.open_start) {
        start = std::min(start.value_or(stay.start), touch(t, stay.start, before, true));
      }
      const bool heel = foot.tracks.size() > 1 && t == foot.tracks.front();
      const bool backward = forward_[frame_at(stay.end)] < 0;
      if (!stance.open_end && (!heel || backward))
        end = std::max(end, touch(t, stay.end, after, false));
    }
    if (start) starts.push_back(*start);
  }
  stance.end = end;
  if (starts.empty()) return;
  stance.start = *std::ranges::min_element(starts);
  stance.open_start = stance.open_start || stance.start <= 0;
  if (!jittery_ || stance.open_start) return;
  // The earliest of several starts that jitter scatters around one time is too early.
  std::erase_if(starts, [&](double start) { return start > stance.start + kTogether; });
  stance.start =
      std::accumulate(starts.begin(), starts.end(), 0.0) / static_cast<double>(starts.size());
}

double WalkingFeet::touch(std::size_t t, double from, double limit, bool first) const {
  const PointTrack& track = found_.tracks[t];
  const double scale = leg_ / kUsualLeg;
  const int step = first ? -1 : 1;
  const double at = from * clip_.rate;
  int f = static_cast<int>(first ? std::floor(at) : std::ceil(at));
  const int last = static_cast<int>(limit * clip_.rate);
  const auto touches = [&](int frame) {
    if (frame < 0 || frame >= clip_.frame_count()) return false;
    if (first ? frame <= last : frame >= last) return false;
    const auto i = static_cast<std::size_t>(frame);
    return track.speed[i] < options_.touch_speed * scale &&
           track.height[i] < options_.touch_height * scale;
  };
  if (!touches(f)) return from;
  while (touches(f + step)) f += step;
  // A foot that rolls over its heel in the first frame, and does not slow down as one that lands,
  // has struck before.
  const auto soon = static_cast<std::size_t>(
      std::clamp<long>(std::lround(clip_.rate / 60), 1, clip_.frame_count() - 1));
  const double slowing = (track.speed[0] - track.speed[soon]) * clip_.rate / double(soon);
  if (first && f == 0 && slowing < 2 * kEndMovement * scale) return 0;
  const double seconds = jittery_ ? kJitteryWindow : kWindow;
  const double window = std::max(seconds * clip_.rate, 4.0);
  const double stiffness = jittery_ ? 0.3 : 0.1;
  const double found = break_near(raw_[t], f, window, first, stiffness);
  if (!first) return std::max(found / clip_.rate, from);
  // Only the part that lands first is decelerated by the ground: the others go down evenly while
  // the foot rolls over it.
  const bool heel = found_.tracks[t].point.part == FootPart::heel;
  const bool backward = forward_[frame_at(from)] < 0;
  const double slowed = heel != backward ? end_of_slowing(t, f, last, found) : found;
  return std::min(slowed / clip_.rate, from);
}

double WalkingFeet::end_of_slowing(std::size_t t, int frame, int earliest, double rest) const {
  const std::vector<double>& speed = found_.tracks[t].speed;
  const auto slowing = [&](int f) {
    return speed[static_cast<std::size_t>(f)] - speed[static_cast<std::size_t>(f) + 1];
  };
  const int last = clip_.frame_count() - 2;
  const int from = std::max({earliest, 0, frame - static_cast<int>(kSlowing * clip_.rate) - 1});
  int most = std::min(from, last);
  for (int f = most; f <= std::min(last, frame + 1); ++f) {
    if (slowing(f) > slowing(most)) most = f;
  }
  const double slowed = options_.landed * slowing(most);
  int f = most + 1;
  while (f <= last && slowing(f) > slowed) ++f;
  if (!(slowed > 0) || f > last) return rest;
  // The deceleration between two frames is that at the time half-way.
  double end = f - 0.5 + (slowing(f - 1) - slowed) / (slowing(f - 1) - slowing(f));
  const auto speed_at = [&](double time) {
    const double at = std::clamp<double>(time, 0, last);
    const auto i = static_cast<std::size_t>(at);
    return speed[i] + (at - std::floor(at)) * (speed[i + 1] - speed[i]);
  };
  // A heel that is still faster than it lands has slowed down in the air, before the ground.
  const double landing = options_.landing_speed * leg_ / kUsualLeg;
  if (speed_at(end) > landing) {
    f = static_cast<int>(end) + 1;
    while (f <= last && speed[static_cast<std::size_t>(f)] > landing) ++f;
    if (f > last) return rest;
    const auto speed_in = [&](int i) { return speed[static_cast<std::size_t>(i)]; };
    end = crossed(speed_in, f, f - 1, clip_.frame_count(), landing);
  }
  const double jitter = kJitterTimes * speed_jitter(jitters_[t], kSpeedCutoff, clip_.rate);
  const double settled = std::ceil(rest + std::max(1.0, kSettling * clip_.rate));
  const bool rests = std::min(speed_at(settled), speed_at(settled + 1)) <
                     std::hypot(kRest * leg_ / kUsualLeg, jitter);
  // At low frame rates speeds are unfiltered, so they cannot show that.
  const bool coarse = clip_.rate < 2.5 * kSpeedCutoff;
  const bool goes_on =
      coarse || speed_at(end) - speed_at(rest) + jitter >= 0.5 * slowed * (rest - end);
  // A heel that is still up lands after the ball, as when descending stairs.
  const double height = found_.tracks[t].height[static_cast<std::size_t>(std::max(0.0, end))];
  const bool is_up = height > kHeelUp * leg_ / kUsualLeg;
  return is_up || (rests && goes_on) ? rest : end;
}

bool WalkingFeet::is_step(const Foot& foot, double from, double to) const {
  const std::size_t first = frame_at(from), last = frame_at(to);
  const double scale = leg_ / kUsualLeg;
  double lift = 1e9, way = 1e9;
  for (const std::size_t t : foot.tracks) {
    const auto& track = tracks_[t];
    const double floor = std::max(track[first].y(), track[last].y());
    double highest = 0;
    for (std::size_t f = first; f <= last; ++f) highest = std::max(highest, track[f].y() - floor);
    lift = std::min(lift, highest);
    way = std::min(way, (track[last] - track[first]).norm());
  }
  return lift > options_.least_lift * scale || way > options_.least_way * scale;
}

bool WalkingFeet::upright(double time) const {
  const std::size_t f = frame_at(time);
  double lowest = 1e9;
  for (const auto& track : tracks_) lowest = std::min(lowest, track[f].y());
  return pelvis_[f].y() - lowest > options_.least_height * leg_;
}

}  // namespace krok::contacts
