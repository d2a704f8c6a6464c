#include "contacts/gait_keytimes.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "contacts/event_pairing_internal.h"
#include "contacts/gait_metrics.h"
#include "contacts/walking_feet_internal.h"
#include "math/window.h"
#include "motion/hips_root.h"
#include "motion/travel.h"

namespace krok::contacts {

namespace {

// Frames and weights for the moment between two frames.
struct Between {
  std::array<int, 4> frames{};
  std::array<float, 4> weights{};
};

// The cubic through two frames on either side; the parabola through three at the clip's ends. The
// first frame is not used for others: it may be a rest pose.
Between between(int frame, int frames) {
  if (frame == 0) return {{1, 2, 3, 3}, {1.875F, -1.25F, 0.375F, 0}};
  if (frame == 1) return {{1, 2, 3, 3}, {0.375F, 0.75F, -0.125F, 0}};
  if (frame + 2 == frames) {
    return {{frames - 1, frames - 2, frames - 3, frames - 3}, {0.375F, 0.75F, -0.125F, 0}};
  }
  return {{frame - 1, frame, frame + 1, frame + 2}, {-0.0625F, 0.5625F, 0.5625F, -0.0625F}};
}

// The clip with a frame between each two, by cubic interpolation of world positions and
// orientations; at least four frames. Feet move by half a metre per frame at 30 frames per second,
// and stop within one: events are found between frames, from speeds that need a higher rate.
Clip doubled_rate(const Clip& clip) {
  Clip dense;
  dense.skeleton = clip.skeleton;
  dense.rate = 2 * clip.rate;
  const int frames = clip.frame_count();
  dense.resize(2 * frames - 1);
  for (int f = 0; f < frames; ++f) {
    std::ranges::copy(clip.frame_positions(f), dense.frame_positions(2 * f).begin());
    std::ranges::copy(clip.frame_orientations(f), dense.frame_orientations(2 * f).begin());
    if (f + 1 == frames) break;
    const Between parts = between(f, frames);
    const auto positions = dense.frame_positions(2 * f + 1);
    const auto orientations = dense.frame_orientations(2 * f + 1);
    for (std::size_t j = 0; j < positions.size(); ++j) {
      Vec3f position = Vec3f::Zero();
      Eigen::Vector4f turn = Eigen::Vector4f::Zero();
      const Quatf& like = clip.frame_orientations(parts.frames[0])[j];
      for (std::size_t i = 0; i < parts.frames.size(); ++i) {
        position += parts.weights[i] * clip.frame_positions(parts.frames[i])[j];
        const Quatf& q = clip.frame_orientations(parts.frames[i])[j];
        turn += (q.dot(like) < 0 ? -parts.weights[i] : parts.weights[i]) * q.coeffs();
      }
      positions[j] = position;
      orientations[j] = turn.norm() > 1e-3F ? Quatf(Eigen::Vector4f(turn.normalized())) : like;
    }
  }
  return dense;
}

}  // namespace

}  // namespace krok::contacts

namespace krok {

namespace {

using contacts::Foot;
using contacts::Stance;

constexpr double kApart = 1e-5;      // seconds
constexpr double kFrame = 1.0 / 60;  // seconds
constexpr double kWhole = 0.75;      // of a stance
constexpr double kJerk = 0.1;        // seconds
constexpr int kFewSeeds = 2;         // events
// Frames per second; below the first, frames are interpolated, up to the second if they do not
// jitter much: interpolated jitter looks like movement.
constexpr double kLowRate = 45, kDenseRate = 100;
constexpr double kMuchJitter = 0.0025;  // metres, frame to frame, for a leg of 0.86 m
constexpr int kMaxDenseFrames = 1 << 20;

class KeytimeFinder {
 public:
  KeytimeFinder(const Clip& clip, const RoleMap& roles, const FoundContacts& found,
                const GaitOptions& options)
      : clip_(clip), found_(found), feet_(clip, roles, found, options) {}

  bool jitters_much() const {
    return feet_.jitter() > kMuchJitter * found_.leg_length / contacts::kUsualLeg;
  }

  Gait find() const {
    Gait gait;
    for (const bool strikes : {true, false}) take_events(strikes, gait);
    std::erase_if(gait.keytimes, [&](const Keytime& key) { return !feet_.upright(key.time); });
    std::ranges::stable_sort(gait.keytimes, {}, &Keytime::time);
    make_alternate(gait);
    leave_out_cut_swings(gait);
    for (std::size_t i = 1; i < gait.keytimes.size(); ++i) {
      gait.keytimes[i].time = std::max(gait.keytimes[i].time, gait.keytimes[i - 1].time + kApart);
    }
    return gait;
  }

 private:
  // A foot that is still behind as the clip ends may slow down, and be taken for one that strikes.
  void leave_out_cut_swings(Gait& gait) const {
    constexpr double kNearEnd = 0.2, kWholeSwing = 0.55;  // seconds; of the usual swing
    const double usual = usual_length(gait.keytimes, false);
    std::vector<Keytime>& keytimes = gait.keytimes;
    for (const std::string side : {"left", "right"}) {
      const auto of_side = [&](const Keytime& key) { return key.name.starts_with(side); };
      const auto last = std::ranges::find_if(keytimes.rbegin(), keytimes.rend(), of_side);
      if (last == keytimes.rend() || !last->name.ends_with("strike")) continue;
      const auto before = std::ranges::find_if(std::next(last), keytimes.rend(), of_side);
      if (before == keytimes.rend() || !before->name.ends_with("off")) continue;
      const bool is_cut = last->time > clip_.duration() - kNearEnd &&
                          last->time - before->time < kWholeSwing * usual;
      if (is_cut) keytimes.erase(std::next(last).base());
    }
  }

  // The median time from the strikes of both feet to their next toe-offs, or from toe-offs to
  // strikes; 0 if there is none.
  static double usual_length(const std::vector<Keytime>& keytimes, bool of_stances) {
    std::vector<double> lengths;
    for (const std::string side : {"left", "right"}) {
      const Keytime* before = nullptr;
      for (const Keytime& key : keytimes) {
        if (!key.name.starts_with(side)) continue;
        const bool begins = before != nullptr && before->name.ends_with("strike") == of_stances;
        if (begins && before->name != key.name) lengths.push_back(key.time - before->time);
        before = &key;
      }
    }
    return lengths.empty() ? 0 : upper_median(lengths);
  }

  // Of two consecutive strikes of a foot that belong to one stance keeps the first, of two toe-offs
  // the last. Where they are a cycle apart and the foot moves in between, the event between them is
  // missing: it is placed by the usual length of stances or swings.
  void make_alternate(Gait& gait) const {
    const double stance = usual_length(gait.keytimes, true);
    const double swing = usual_length(gait.keytimes, false);
    std::vector<Keytime> missing;
    for (std::size_t s = 0; s < 2 && stance > 0 && swing > 0; ++s) {
      const std::string side = name_of(static_cast<FootSide>(s));
      const Keytime* before = nullptr;
      for (const Keytime& key : gait.keytimes) {
        if (!key.name.starts_with(side)) continue;
        const bool again = before != nullptr && before->name == key.name;
        const bool strikes = key.name.ends_with("strike");
        const auto& foot = feet_.foot(s);
        if (again && key.time - before->time > kWhole * (stance + swing) &&
            feet_.moves(foot, before->time, key.time) &&
            feet_.stays_low(foot, strikes ? before->time : key.time, strikes)) {
          const double part = (strikes ? stance : swing) / (stance + swing);
          missing.push_back({before->time + part * (key.time - before->time),
                             side + (strikes ? "_off" : "_strike")});
        }
        before = &key;
      }
    }
    gait.from_seeds += static_cast<int>(missing.size());
    gait.keytimes.insert(gait.keytimes.end(), missing.begin(), missing.end());
    std::ranges::stable_sort(gait.keytimes, {}, &Keytime::time);
    leave_out_repeated(gait.keytimes);
  }

  static void leave_out_repeated(std::vector<Keytime>& keytimes) {
    std::vector<std::uint8_t> kept(keytimes.size(), 1);
    for (const char* side : {"left", "right"}) {
      std::size_t before = keytimes.size();
      for (std::size_t i = 0; i < keytimes.size(); ++i) {
        if (!keytimes[i].name.starts_with(side)) continue;
        if (before < keytimes.size() && keytimes[before].name == keytimes[i].name) {
          const bool strike = keytimes[i].name.ends_with("strike");
          kept[strike ? i : before] = 0;
          if (strike) continue;
        }
        before = i;
      }
    }
    std::size_t place = 0;
    for (std::size_t i = 0; i < keytimes.size(); ++i) {
      if (kept[i]) keytimes[place++] = keytimes[i];
    }
    keytimes.resize(place);
  }

  std::vector<double> starts_of(const Foot& foot) const {
    std::vector<double> times;
    for (const Stance& stance : foot.stances) {
      if (!stance.open_start) times.push_back(stance.start);
    }
    // In a capture that starts with a jerk, standing feet seem to strike at once.
    const bool jerk = !times.empty() && times.front() == foot.stances.front().start &&
                      times.front() < kJerk && is_cut_short(foot, times.front());
    if (jerk) times.erase(times.begin());
    return times;
  }
  std::vector<double> ends_of(const Foot& foot) const {
    std::vector<double> times;
    for (const Stance& stance : foot.stances) {
      if (!stance.open_end) times.push_back(stance.end);
    }
    return times;
  }

  contacts::Pairing pairing(std::size_t side, bool strikes) const {
    const Foot& foot = feet_.foot(side);
    contacts::Pairing pair;
    pair.all = &foot.seeds;
    pair.seeds = strikes ? &foot.seeds.front : &foot.seeds.back;
    pair.cycle = foot.cycle;
    pair.stances = foot.stances;
    pair.is_low = [this, &foot, strikes](double seed) {
      return feet_.stays_low(foot, seed, strikes);
    };
    pair.moves = [this, &foot](double from, double to) { return feet_.moves(foot, from, to); };
    if (!strikes) {
      pair.toes_unseen = !feet_.has_tip(foot);
      pair.rolls_off = [this, &foot](double seed) -> std::optional<double> {
        if (!feet_.rolls_off(foot, seed)) return std::nullopt;
        return feet_.toes_back(foot, seed) + contacts::kOffAfterToes;
      };
    }
    pair.events = strikes ? starts_of(foot) : ends_of(foot);
    pair.pair();
    return pair;
  }

  void take_events(bool strikes, Gait& gait) const {
    std::array<contacts::Pairing, 2> pairs = {pairing(0, strikes), pairing(1, strikes)};
    std::vector<double> offsets, early;
    for (contacts::Pairing& pair : pairs) {
      pair.add_offsets(offsets);
      // Also where the toes of one foot alone bend too little.
      std::vector<double> early_here;
      pair.add_early(early_here);
      if (contacts::leave_early(early_here)) pair.toes_unseen = true;
      early.insert(early.end(), early_here.begin(), early_here.end());
    }
    if (contacts::leave_early(early)) pairs[0].toes_unseen = pairs[1].toes_unseen = true;
    const contacts::Offset offset = contacts::offset_of(
        offsets, strikes ? contacts::kStrikeAfterFront : contacts::kOffAfterBack, feet_.jittery());
    for (std::size_t s = 0; s < 2; ++s) {
      contacts::Events events = pairs[s].events_with(offset);
      if (strikes) {
        add_first_strike(feet_.foot(s), events.times);
        add_last_strike(feet_.foot(s), events.times);
      }
      gait.from_seeds += events.from_seeds;
      const std::string name =
          fmt::format("{}_{}", name_of(static_cast<FootSide>(s)), strikes ? "strike" : "off");
      for (const double time : events.times) {
        if (time >= 0 && time <= clip_.duration()) gait.keytimes.push_back({time, name});
      }
    }
  }

  // A clip cut at a strike starts while the foot rolls over its heel. How long that takes is known
  // from the other strikes.
  void add_first_strike(const Foot& foot, std::vector<double>& strikes) const {
    if (foot.stances.empty() || !foot.stances.front().open_start || foot.tracks.size() < 2) return;
    std::vector<double> rolls;
    double first_roll = -1;
    for (const Stance& stance : foot.stances) {
      double flat = -1;
      for (const Stay& stay : found_.stays) {
        if (static_cast<std::size_t>(stay.track) != foot.tracks[1]) continue;
        if (stay.start < stance.start - 1e-9 || stay.start > stance.end) continue;
        if (flat < 0 || stay.start < flat) flat = stay.open_start ? 0 : stay.start;
      }
      if (flat < 0) continue;
      if (stance.open_start) {
        first_roll = flat;
      } else {
        rolls.push_back(flat - stance.start);
      }
    }
    if (rolls.empty() || !(first_roll > 0)) return;
    const double strike = first_roll - upper_median(rolls);
    if (is_cut_short(foot, strike)) return;
    if (strike > -kFrame && strike < std::min(first_roll, 3 * kFrame)) {
      strikes.insert(strikes.begin(), std::max(0.0, strike));
    }
  }

  // Whether the first stance is too short to have begun at that strike, so that the clip starts in
  // the middle of it.
  static bool is_cut_short(const Foot& foot, double strike) {
    std::vector<double> lengths;
    for (const Stance& stance : foot.stances) {
      if (!stance.open_start && !stance.open_end) lengths.push_back(stance.end - stance.start);
    }
    if (lengths.empty() || foot.stances.front().open_end) return false;
    return foot.stances.front().end - strike < kWhole * upper_median(lengths);
  }

  // A clip cut at a strike ends with a foot about to touch, a usual swing after its toe-off; the
  // few frames of its slowing down give no better estimate.
  void add_last_strike(const Foot& foot, std::vector<double>& strikes) const {
    std::vector<double> swings;
    for (std::size_t i = 1; i < foot.stances.size(); ++i) {
      swings.push_back(foot.stances[i].start - foot.stances[i - 1].end);
    }
    if (swings.size() < 2) return;
    const double end = clip_.duration();
    const bool begun = foot.stances.back().open_end && foot.stances.back().start > end - 3 * kFrame;
    if (foot.stances.back().open_end && !begun) return;
    const Stance& last = foot.stances[foot.stances.size() - (begun ? 2 : 1)];
    if (begun) swings.pop_back();
    const double expected = last.end + upper_median(swings);
    if (expected < end - 3 * kFrame || expected > end + 1.5 * kFrame) return;
    while (!strikes.empty() && strikes.back() > last.end) strikes.pop_back();
    strikes.push_back(std::min(expected, end));
  }

  const Clip& clip_;
  const FoundContacts& found_;
  contacts::WalkingFeet feet_;
};

Gait find_between_frames(const Clip& clip, const RoleMap& roles, const GaitOptions& options,
                         bool jittery) {
  Clip dense = contacts::doubled_rate(clip);
  while (!jittery && dense.rate < kDenseRate && dense.frame_count() < kMaxDenseFrames) {
    dense = contacts::doubled_rate(dense);
  }
  const auto found = find_contacts(dense, roles);
  return found ? KeytimeFinder(dense, roles, *found, options).find() : Gait();
}

// Metres per second, over the whole clip and along its path.
double travel_speed(const Clip& clip, const RoleMap& roles) {
  const auto carrier = static_cast<std::size_t>(carrying_joint(roles));
  const int part = std::max(1, static_cast<int>(clip.rate));  // a second: sway does not count
  const std::vector<Jump> jumps = jumps_of(clip, carrying_joint(roles));
  double way = 0;
  int frames = 0;
  for (int f = 0; f + 1 < clip.frame_count(); f += part) {
    const int to = std::min(f + part, clip.frame_count() - 1);
    // Jumps are no travel, and ends at which a pose is held no time of it.
    const bool jumps_here = std::ranges::any_of(
        jumps, [&](const Jump& jump) { return jump.frame > f && jump.frame <= to; });
    if (jumps_here || clip.frame_positions(f)[carrier] == clip.frame_positions(to)[carrier]) {
      continue;
    }
    frames += to - f;
    const Vec3f moved = clip.frame_positions(to)[carrier] - clip.frame_positions(f)[carrier];
    way += std::hypot(static_cast<double>(moved.x()), static_cast<double>(moved.z()));
  }
  return frames == 0 ? 0 : way * clip.rate / frames;
}

}  // namespace

Gait find_gait(const Clip& clip, const RoleMap& roles, const FoundContacts& found,
               const GaitOptions& options) {
  Gait gait;
  if (clip.frame_count() >= 3 && !found.tracks.empty() && found.leg_length > 0) {
    const KeytimeFinder finder(clip, roles, found, options);
    const bool interpolates = clip.rate < (finder.jitters_much() ? kLowRate : kDenseRate) &&
                              clip.frame_count() >= 4 && clip.frame_count() < kMaxDenseFrames;
    gait = interpolates ? find_between_frames(clip, roles, options, finder.jitters_much())
                        : finder.find();
  }
  const auto warn = [&](std::string code, std::string message, std::string hint) {
    gait.warnings.push_back(make_warning(std::move(code), std::move(message), std::move(hint)));
  };
  if (gait.keytimes.empty()) {
    warn("gait-none", "no step was found", "");
  } else if (found.contacts.empty()) {
    warn("gait-in-place",
         "no foot contact was found, so keytimes are when each foot is furthest ahead of or behind "
         "the pelvis",
         "feet slide when walking in place; strikes and toe-offs are accurate to about 30 ms");
  } else if (gait.from_seeds > 0) {
    warn("gait-seeds",
         fmt::format("{} of {} keytimes have no matching contact", gait.from_seeds,
                     gait.keytimes.size()),
         "they are estimated from the foot's extremes relative to the pelvis; check them with "
         "--plot");
    // The one or two events at a clip's ends, which have no contact to be matched, are usual.
    if (gait.from_seeds <= kFewSeeds &&
        8 * gait.from_seeds <= static_cast<int>(gait.keytimes.size())) {
      gait.warnings.back().severity = Severity::note;
    }
  }
  if (!found.contacts.empty()) {
    for (Diagnostic& implausible :
         check_gait(gait_metrics(gait.keytimes), travel_speed(clip, roles), found.leg_length)) {
      gait.warnings.push_back(std::move(implausible));
    }
  }
  return gait;
}

}  // namespace krok
