#include "contacts/loop_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "contacts/event_pairing_internal.h"
#include "contacts/sole_points.h"
#include "math/window.h"
#include "motion/hips_root.h"
#include "motion/loop.h"
#include "motion/travel.h"

namespace krok {

namespace {

constexpr int kRounds = 3, kMinLoopFrames = 8;
constexpr double kLongestLoop = 20;                // seconds
constexpr double kGap = 0.012, kShift = 0.02;      // of the reference pose's extent
constexpr double kGapOfMotion = 0.05;              // of the largest distance from the first pose
constexpr double kTurn = 5 * kRadiansPerDegree;    // of a loop in place
constexpr double kSampleRate = 30;                 // per second, of the feet's velocities
constexpr double kLow = 0.05;                      // metres, for a leg of 0.86 m
constexpr double kSpread = 0.1, kSpreadOf = 0.25;  // metres per second; of the speed
constexpr double kSlowestTravel = 0.15;            // metres per second, for a leg of 0.86 m
constexpr double kMinHeight = 0.6;                 // of the pelvis, in leg lengths
// Of the time, in which a foot is on the ground; of that, in which each is alone; of the time in
// which points are low.
constexpr double kMinDown = 0.08, kMinAlone = 0.15, kMinOfLow = 0.55;
// Of the mean velocity, in the opposite direction; of the low points.
constexpr double kOpposed = 0.25, kMaxOpposed = 0.05;

// The largest distance of a joint from where a move takes it from one frame to another.
double distance_of(const Clip& clip, int from, int to, const Transform& move) {
  const auto before = clip.frame_positions(from), after = clip.frame_positions(to);
  double largest = 0;
  for (std::size_t j = 0; j < before.size(); ++j) {
    const Vec3 there = move * Vec3(before[j].cast<double>());
    largest = std::max(largest, (there - after[j].cast<double>()).norm());
  }
  return largest;
}

Transform way(const Clip& clip, int carrier, int from, int to) {
  Transform move = ground_frame(clip, carrier, to).to_world() *
                   ground_frame(clip, carrier, from).to_world().inverse();
  const auto j = static_cast<std::size_t>(carrier);
  move.position.y() = clip.frame_positions(to)[j].y() - clip.frame_positions(from)[j].y();
  return move;
}

struct Sample {
  std::size_t side = 0;  // FootSide
  int time = 0;          // in samples
  Vec3 velocity = Vec3::Zero();
};

// The velocities of the points of the soles of a loop in place, where they are low.
class LowPoints {
 public:
  LowPoints(const Clip& loop, const Feet& feet) : scale_(feet.leg_length / contacts::kUsualLeg) {
    const int period = loop.frame_count() - 1;
    step_ = std::max(1, static_cast<int>(std::lround(loop.rate / kSampleRate)));
    count_ = period / step_;
    for (std::size_t side = 0; side < 2; ++side) {
      for (const SolePoint& point : feet.points[side]) {
        const std::vector<Vec3> track = track_of(loop, point, feet.leg_length);
        double lowest = INFINITY;
        for (const Vec3& place : track) lowest = std::min(lowest, place.y());
        for (int i = 0; i < count_; ++i) {
          const Vec3& from = track[static_cast<std::size_t>(i * step_)];
          const Vec3& to = track[static_cast<std::size_t>((i + 1) * step_)];
          if (std::max(from.y(), to.y()) > lowest + kLow * scale_) continue;
          Vec3 velocity = (to - from) * loop.rate / step_;
          velocity.y() = 0;
          samples_.push_back({side, i, velocity});
        }
      }
    }
  }

  // The velocity of feet that walk; zero if they do not.
  Vec3 walking() {
    const Vec3 common = common_velocity();
    const double slowest = kSlowestTravel * scale_;
    if (common.norm() < slowest) return Vec3::Zero();
    if (alternate([&](const Sample& sample) { return is_about(common, sample.velocity); })) {
      return common;
    }
    // Feet that slow down and speed up on the ground, as some that were animated by hand.
    const Vec3 mean = mean_of(samples_, [](const Sample&) { return true; });
    const auto opposed = std::ranges::count_if(samples_, [&](const Sample& sample) {
      return sample.velocity.dot(mean) < -kOpposed * mean.squaredNorm();
    });
    const bool one_way =
        static_cast<double>(opposed) <= kMaxOpposed * static_cast<double>(samples_.size());
    const bool walks = mean.norm() >= slowest && one_way &&
                       alternate([&](const Sample& s) { return s.velocity.dot(mean) > 0; });
    return walks ? mean : Vec3::Zero();
  }

  // The strikes and toe-offs of feet that walk, as walking() found them: to a sample.
  std::vector<Keytime> keytimes(double rate) const {
    std::vector<Keytime> keytimes;
    for (const std::size_t side : {0, 1}) {
      const std::string foot = name_of(static_cast<FootSide>(side));
      const auto is_down = [&](int time) {
        const auto i = static_cast<std::size_t>((time + count_) % count_);
        const auto before = (i + down_[side].size() - 1) % down_[side].size();
        const auto after = (i + 1) % down_[side].size();
        // A gap of one sample is none.
        return down_[side][i] != 0 || (down_[side][before] != 0 && down_[side][after] != 0);
      };
      for (int i = 0; i < count_; ++i) {
        if (is_down(i) == is_down(i - 1)) continue;
        keytimes.push_back({i * step_ / rate, foot + (is_down(i) ? "_strike" : "_off")});
      }
    }
    std::ranges::stable_sort(keytimes, {}, &Keytime::time);
    return keytimes;
  }

 private:
  bool is_about(const Vec3& velocity, const Vec3& other) const {
    return (other - velocity).norm() < kSpread * scale_ + kSpreadOf * velocity.norm();
  }

  template <typename IsTaken>
  static Vec3 mean_of(const std::vector<Sample>& samples, const IsTaken& is_taken) {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (const Sample& sample : samples) {
      if (!is_taken(sample)) continue;
      sum += sample.velocity;
      ++count;
    }
    return sum / std::max(1, count);
  }

  // The mean of the velocities that most are alike.
  Vec3 common_velocity() const {
    Vec3 best = Vec3::Zero();
    std::ptrdiff_t most = 0;
    for (const Sample& center : samples_) {
      const auto alike = std::ranges::count_if(samples_, [&](const Sample& sample) {
        return is_about(center.velocity, sample.velocity);
      });
      if (alike <= most) continue;
      most = alike;
      best = center.velocity;
    }
    for (int round = 0; round < 3; ++round) {
      best = mean_of(samples_, [&](const Sample& s) { return is_about(best, s.velocity); });
    }
    return best;
  }

  // Whether feet walk that are on the ground in these samples: one is while the other one swings,
  // and at most times at which any point is low.
  template <typename IsDown>
  bool alternate(const IsDown& is_down) {
    std::array<std::vector<std::uint8_t>, 2>&down = down_, low;
    for (const std::size_t side : {0, 1}) {
      low[side].assign(static_cast<std::size_t>(count_), 0);
      down[side] = low[side];
    }
    for (const Sample& sample : samples_) {
      const auto time = static_cast<std::size_t>(sample.time);
      low[sample.side][time] = 1;
      if (is_down(sample)) down[sample.side][time] = 1;
    }
    std::array<int, 2> alone{};
    int any_down = 0, any_low = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count_); ++i) {
      any_down += down[0][i] + down[1][i] > 0 ? 1 : 0;
      any_low += low[0][i] + low[1][i] > 0 ? 1 : 0;
      for (const std::size_t side : {0, 1}) alone[side] += down[side][i] > down[1 - side][i];
    }
    return any_down >= kMinDown * count_ && any_down >= kMinOfLow * any_low &&
           std::min(alone[0], alone[1]) >= kMinAlone * any_down;
  }

  double scale_;
  int step_ = 1, count_ = 0;
  std::vector<Sample> samples_;
  std::array<std::vector<std::uint8_t>, 2> down_;  // [FootSide][samples]
};

// How high the pelvis is above the lowest point of the feet, metres: the median.
double pelvis_height(const Clip& clip, const RoleMap& roles) {
  const auto hips = static_cast<std::size_t>(carrying_joint(roles));
  const std::vector<int> feet = foot_joints(clip.skeleton, roles);
  std::vector<double> heights;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const auto places = clip.frame_positions(f);
    double lowest = INFINITY;
    for (const int j : feet) {
      lowest = std::min<double>(lowest, places[static_cast<std::size_t>(j)].y());
    }
    heights.push_back(places[hips].y() - lowest);
  }
  return upper_median(heights);
}

// Empty for a character that is low, or has no legs.
std::optional<LowPoints> low_points(const Clip& loop, const RoleMap& roles) {
  const Feet feet = find_feet(loop, roles);
  if (!(feet.leg_length > 0) || loop.frame_count() < kMinLoopFrames) return std::nullopt;
  if (pelvis_height(loop, roles) < kMinHeight * feet.leg_length) return std::nullopt;
  return LowPoints(loop, feet);
}

// Whether each foot has a strike and a toe-off.
bool are_of_both(const std::vector<Keytime>& keytimes) {
  for (const char* name : {"left_strike", "left_off", "right_strike", "right_off"}) {
    if (std::ranges::find(keytimes, name, &Keytime::name) == keytimes.end()) return false;
  }
  return true;
}

// A circle's events, `first` to `last` in seconds, with times from the first on.
std::vector<Keytime> keytimes_between(const std::vector<Keytime>& all, double first, double last,
                                      double same) {
  constexpr double kMinApart = 1e-5;  // seconds
  std::vector<Keytime> keytimes;
  for (const Keytime& key : all) {
    if (key.time < first - same || key.time > last + same) continue;
    keytimes.push_back({std::clamp(key.time - first, 0.0, last - first), key.name});
  }
  for (std::size_t i = 1; i < keytimes.size(); ++i) {
    keytimes[i].time = std::max(keytimes[i].time, keytimes[i - 1].time + kMinApart);
  }
  return keytimes;
}

// Contacts, stays and tracks of the round in the middle.
FoundContacts middle_of(const FoundContacts& all, const Rounds& rounds) {
  const double start = rounds.period / rounds.clip.rate, end = 2 * start;
  const Transform back = rounds.displacement.inverse();
  FoundContacts found = all;
  for (PointTrack& track : found.tracks) {
    for (std::vector<double>* values : {&track.speed, &track.height}) {
      if (values->size() < static_cast<std::size_t>(2 * rounds.period + 1)) continue;
      values->resize(static_cast<std::size_t>(2 * rounds.period + 1));
      values->erase(values->begin(), values->begin() + rounds.period);
    }
  }
  const auto cut = [&](auto& parts) {
    std::erase_if(parts, [&](auto& part) {
      part.start = std::max(part.start, start) - start;
      part.end = std::min(part.end, end) - start;
      part.place = back * part.place;
      return (part.end - part.start) * rounds.clip.rate < 1;
    });
  };
  for (Stay& stay : found.stays) {
    stay.open_start = stay.start <= start;
    stay.open_end = stay.end >= end;
  }
  cut(found.stays);
  cut(found.contacts);
  std::ranges::sort(found.contacts, {},
                    [](const Contact& contact) { return std::pair(contact.start, contact.joint); });
  return found;
}

}  // namespace

std::optional<Transform> loop_displacement(const Clip& clip, int carrier) {
  const int last = clip.frame_count() - 1;
  if (clip.frame_count() < kMinLoopFrames || clip.duration() > kLongestLoop) return std::nullopt;
  const Transform whole = way(clip, carrier, 0, last);
  const double gap = distance_of(clip, 0, last, whole);
  if (gap > kGap * reference_extent(clip.skeleton)) return std::nullopt;
  double moved = 0;
  for (int f = 1; f < last; ++f) {
    moved = std::max(moved, distance_of(clip, 0, f, way(clip, carrier, 0, f)));
  }
  if (gap > kGapOfMotion * moved) return std::nullopt;
  return whole;
}

bool is_in_place(const Transform& displacement, const Skeleton& skeleton) {
  const double turn = 2 * std::atan2(displacement.orientation.y(), displacement.orientation.w());
  return displacement.position.norm() < kShift * reference_extent(skeleton) &&
         std::abs(wrapped(turn)) < kTurn;
}

Vec3 velocity_of_feet(const Clip& loop, const RoleMap& roles) {
  auto points = low_points(loop, roles);
  if (!points) return Vec3::Zero();
  const Vec3 velocity = points->walking();
  return velocity.isZero() ? velocity : Vec3(-velocity);
}

std::optional<Clip> travelling_on_feet(const Clip& clip, const RoleMap& roles) {
  const int carrier = carrying_joint(roles);
  if (clip.provenance.removed_root_motion) return travelling(clip, carrier);
  const auto displacement = loop_displacement(clip, carrier);
  if (!displacement || !is_in_place(*displacement, clip.skeleton)) return std::nullopt;
  const Vec3 velocity = velocity_of_feet(clip, roles);
  if (velocity.isZero()) return std::nullopt;
  return carried_along(clip, carrier, {velocity, 0});
}

std::optional<Rounds> rounds_of(const Clip& clip, const RoleMap& roles) {
  const int carrier = carrying_joint(roles);
  const auto displacement = loop_displacement(clip, carrier);
  if (!displacement) return std::nullopt;
  auto played = repeated(clip, *displacement, kRounds);
  if (!played) return std::nullopt;
  Rounds rounds{*std::move(played), clip.frame_count() - 1, {}};
  RootMotion removed = clip.provenance.removed_root_motion.value_or(RootMotion{});
  const bool estimated =
      !clip.provenance.removed_root_motion && is_in_place(*displacement, clip.skeleton);
  if (estimated) removed.velocity = velocity_of_feet(clip, roles);
  if (!removed.velocity.isZero() || removed.turn_rate != 0) {
    rounds.clip = carried_along(rounds.clip, carrier, removed);
  }
  rounds.displacement = way(rounds.clip, carrier, 0, rounds.period);
  return rounds;
}

std::vector<Keytime> in_rounds(const std::vector<Keytime>& keytimes, const Rounds& rounds) {
  const double duration = rounds.period / rounds.clip.rate, same = 0.5 / rounds.clip.rate;
  std::vector<Keytime> own = keytimes;
  std::erase_if(own, [&](const Keytime& key) {
    return key.time > duration - same && std::ranges::any_of(keytimes, [&](const Keytime& first) {
             return first.name == key.name && first.time < same;
           });
  });
  std::vector<Keytime> all;
  for (int round = 0; round < kRounds; ++round) {
    for (const Keytime& key : own) all.push_back({key.time + round * duration, key.name});
  }
  return all;
}

namespace {

// Whether a foot strikes twice.
bool has_a_cycle(const std::vector<Keytime>& keytimes) {
  return std::ranges::any_of(std::array{"left_strike", "right_strike"}, [&](const char* name) {
    return std::ranges::count(keytimes, name, &Keytime::name) > 1;
  });
}

}  // namespace

Result<FoundSteps> find_steps(const Clip& clip, const RoleMap& roles) {
  const auto rounds = rounds_of(clip, roles);
  const auto moving = travelling_on_feet(clip, roles);
  if (rounds && !moving) {
    // A walk of several steps ends in its first pose, too, and shows them by itself.
    auto plain = find_contacts(clip, roles);
    if (!plain) return std::move(plain).error();
    Gait gait = find_gait(clip, roles, *plain);
    if (has_a_cycle(gait.keytimes)) return FoundSteps{*std::move(plain), std::move(gait)};
  }
  const Clip& played = rounds ? rounds->clip : moving ? *moving : clip;
  auto contacts = find_contacts(played, roles);
  if (!contacts) return std::move(contacts).error();
  FoundSteps steps{{}, find_gait(played, roles, *contacts)};
  steps.contacts = rounds ? middle_of(*contacts, *rounds) : *std::move(contacts);
  if (moving) place_contacts(clip, steps.contacts.contacts);
  if (!rounds) return steps;
  const double duration = rounds->period / clip.rate;
  steps.gait.keytimes =
      keytimes_between(steps.gait.keytimes, duration, 2 * duration, 0.5 / clip.rate);
  const bool estimated = moving && !clip.provenance.removed_root_motion;
  if (!estimated || are_of_both(steps.gait.keytimes)) return steps;
  // Feet that never rest for long, as in runs of few frames.
  if (auto points = low_points(clip, roles); points && !points->walking().isZero()) {
    steps.gait.keytimes = points->keytimes(clip.rate);
    steps.contacts.warnings.clear();
    steps.gait.warnings = {make_warning(
        "gait-in-place", "feet slide at the speed of the loop, so keytimes are to a frame",
        "check them with krok-keys --plot")};
  }
  return steps;
}

}  // namespace krok
