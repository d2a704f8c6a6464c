#include "plant/plant_feet.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "contacts/contacts.h"
#include "contacts/gait_keytimes.h"
#include "contacts/gait_metrics.h"
#include "plant/foot_paths_internal.h"
#include "plant/legs_internal.h"
#include "plant/smooth_curve_internal.h"

namespace krok::plant {

namespace {

constexpr double kSharedCutoff = 4;  // Hz, above which movement may be jitter
// Ratio of the variance of jitter to that from frame to frame: most is slower than white noise.
constexpr double kSlower = 30;

// A curve without its slow part.
KnownCurve fast_part(const KnownCurve& curve, double rate) {
  const std::vector<Vec3> slow = smooth_curve(curve, {.rate = rate, .cutoff = kSharedCutoff});
  KnownCurve fast(curve.values.size());
  for (std::size_t f = 0; f < slow.size(); ++f) {
    if (curve.is_exact(f)) fast.set(f, curve.values[f] - slow[f]);
  }
  return fast;
}

// The correction that removes shared jitter; `jitter` is the standard deviation of the pelvis'
// jitter. Each standing foot measures it with an error of its own, and so does the pelvis, whose
// error is its real movement. Their covariance is the variance of the shared jitter, and what they
// vary by beyond that is error. The estimate is the mean weighted by inverse variances, zero
// included with the variance of the jitter (Wiener filter).
std::vector<Vec3> shared_jitter(const KnownCurve& hips, const std::vector<KnownCurve>& feet,
                                double jitter) {
  const std::size_t frames = hips.values.size();
  std::vector<Vec3> result(frames, Vec3::Zero());
  double both = 0, of_feet = 0, of_hips = 0;
  int count = 0;
  for (const KnownCurve& foot : feet) {
    for (std::size_t f = 0; f < frames; ++f) {
      if (!foot.is_exact(f)) continue;
      both += foot.values[f].dot(hips.values[f]);
      of_feet += foot.values[f].squaredNorm();
      of_hips += hips.values[f].squaredNorm();
      ++count;
    }
  }
  // Landings move feet and pelvis alike, too, but without jitter from frame to frame.
  both = std::min(both, 3 * kSlower * jitter * jitter * count);
  if (count < 3 || !(both > 0)) return result;
  constexpr double kMin = 1e-3;  // of the jitter's variance
  const double foot_weight = both / std::max(of_feet - both, kMin * both);
  const double hips_weight = both / std::max(of_hips - both, kMin * both);
  for (std::size_t f = 0; f < frames; ++f) {
    Vec3 sum = hips_weight * hips.values[f];
    double weight = 1 + hips_weight;
    for (const KnownCurve& foot : feet) {
      if (!foot.is_exact(f)) continue;
      sum += foot_weight * foot.values[f];
      weight += foot_weight;
    }
    result[f] = sum / weight;
  }
  return result;
}

// Negative, to be compared with the shifts that bring feet back.
KnownCurve pelvis_track(const PlantedBody& body, const Clip& clip) {
  KnownCurve hips(static_cast<std::size_t>(clip.frame_count()));
  for (int f = 0; f < clip.frame_count(); ++f) {
    hips.set(static_cast<std::size_t>(f), -joint_at(clip, f, body.pelvis).position);
  }
  return hips;
}

// The deviation of the pelvis' jitter from frame to frame, metres.
double pelvis_jitter(const PlantedBody& body, const Clip& clip) {
  return jitter_of(pelvis_track(body, clip));
}

// Removes the jitter that feet and pelvis share from the pelvis and all joints below it. `shifts`,
// one for each leg, bring the feet to their places; `jitter` is that of the captured pelvis.
// Returns the root mean square of the removed jitter, metres.
double steady(const PlantedBody& body, const std::vector<KnownCurve>& shifts, double jitter,
              Clip& clip) {
  const KnownCurve hips = pelvis_track(body, clip);
  std::vector<KnownCurve> feet;
  for (const KnownCurve& shift : shifts) feet.push_back(fast_part(shift, clip.rate));
  const std::vector<Vec3> still = shared_jitter(fast_part(hips, clip.rate), feet, jitter);
  double squares = 0;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Vec3& shift = still[static_cast<std::size_t>(f)];
    squares += shift.squaredNorm();
    for (std::size_t j = 0; j < body.bodies.size(); ++j) {
      if (body.bodies[j] == Body::none) continue;
      Vec3f& position = clip.frame_positions(f)[j];
      position = (position.cast<double>() + shift).cast<float>();
    }
  }
  return std::sqrt(squares / clip.frame_count());
}

}  // namespace

}  // namespace krok::plant

namespace krok {

namespace {

// Jitter of the whole body, in leg lengths, from which contacts are found again after its removal.
constexpr double kShakes = 0.003;

// Rounds of contact detection: feet that stand still show longer stays than feet that slide.
constexpr int kRounds = 3;

// Passes, each over the result of the one before, until one finds nothing to correct: where the
// sole points are depends on how the feet stand.
constexpr int kPasses = 8;

// Stances without a contact from which there is a warning: their number, and their share.
constexpr int kFewMissed = 2;
constexpr double kPartMissed = 0.2;

// Of the leg, from frame to frame, and of the frames of a stance, of feet that have been planted.
// In captures of five sets 0 to 24 % of steps are as small, in planted ones 65 to 100 %.
constexpr double kHeldStep = 1e-4, kHeldPart = 0.4;
constexpr std::size_t kFewSteps = 4;
// What a short touch leaves, once or twice in a motion, does not count: seconds, and of all steps.
constexpr double kFewMissedFor = 0.2, kMissedPart = 0.1;

void note_stays(const plant::PlantedBody& body, const std::vector<plant::Footing>& captured,
                const std::vector<plant::Footing>& footings, PlantedFeet& planted) {
  for (std::size_t i = 0; i < body.legs.size(); ++i) {
    for (std::size_t p = 0; p < body.legs[i].points.size(); ++p) {
      const SolePoint& point = body.legs[i].points[p];
      std::vector<Vec3> after;
      after.reserve(static_cast<std::size_t>(planted.clip.frame_count()));
      for (int f = 0; f < planted.clip.frame_count(); ++f) {
        after.push_back(joint_at(planted.clip, f, point.joint) * point.offset);
      }
      for (FixedStay stay : footings[i].stays) {
        if (stay.point.part != point.part) continue;
        stay.drift_before = plant::drift_of(captured[i].tracks[p], stay.first, stay.last);
        stay.drift_after = plant::drift_of(after, stay.first, stay.last);
        planted.stays.push_back(stay);
        if (point.part == FootPart::tip) continue;
        planted.drift_before = std::max(planted.drift_before, stay.drift_before);
        planted.drift_after = std::max(planted.drift_after, stay.drift_after);
      }
    }
  }
}

// How far a point moves along the ground, metres.
double level_drift(const Clip& clip, const FixedStay& stay) {
  std::vector<Vec3> track;
  for (int f = stay.first; f <= stay.last; ++f) {
    track.push_back(joint_at(clip, f, stay.point.joint) * stay.point.offset);
    track.back().y() = 0;
  }
  return plant::drift_of(track, 0, stay.last - stay.first);
}

void note_rolls(const plant::Leg& leg, const plant::Footing& footing, PlantedFeet& planted) {
  for (const plant::Roll& roll : footing.rolls) {
    const std::size_t frames = roll.points.size();
    for (std::size_t from = 0, to = 0; from < frames; from = to) {
      while (to < frames && roll.points[to] == roll.points[from]) ++to;
      const int a = roll.from + roll.step * static_cast<int>(from);
      const int b = roll.from + roll.step * static_cast<int>(to);
      FixedStay stay{leg.points[static_cast<std::size_t>(roll.points[from])], std::min(a, b),
                     std::max(a, b)};
      stay.place = joint_at(planted.clip, a, stay.point.joint) * stay.point.offset;
      stay.drift_after = level_drift(planted.clip, stay);
      planted.roll_after = std::max(planted.roll_after, stay.drift_after);
      planted.rolls.push_back(stay);
    }
  }
}

Diagnostic reach_warning(int frames, const Clip& clip) {
  return make_warning(
      "plant-reach",
      fmt::format(
          "in {} of {} frames a leg is too short to reach where its foot stands, so that the foot "
          "slides",
          frames, clip.frame_count()),
      "are contacts marked where the foot does not stand?");
}

// Stances of walking in which neither heel nor ball was held, if they are more than a few.
Diagnostics missed_stances(const Clip& clip, const RoleMap& roles, const FoundContacts& found,
                           const std::vector<FixedStay>& stays) {
  const std::vector<Keytime> keytimes = find_gait(clip, roles, found).keytimes;
  int stances = 0, missed = 0;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    for (const StanceTimes& stance : stance_times(keytimes, side)) {
      ++stances;
      const bool held = std::ranges::any_of(stays, [&](const FixedStay& stay) {
        return stay.point.side == side && stay.point.part != FootPart::tip &&
               stay.first < stance.off * clip.rate && stay.last > stance.strike * clip.rate;
      });
      missed += held ? 0 : 1;
    }
  }
  if (missed < kFewMissed || missed < kPartMissed * stances) return {};
  return {make_warning(
      "plant-missed",
      fmt::format("in {} of {} stances no contact was found, so that the foot is not held there",
                  missed, stances),
      "jitter or sliding hides them: smooth the motion more (krok-edit --filter butterworth "
      "--cutoff 4Hz), or give "
      "--contacts")};
}

// Whether feet have been planted: in much of each stance one point of the foot, not always
// the same, does not move along the ground.
bool is_held(const Clip& clip, const FoundContacts& found) {
  std::array<std::vector<std::uint8_t>, 2> touches, still;  // [FootSide][steps to the next frame]
  const auto steps = static_cast<std::size_t>(std::max(0, clip.frame_count() - 1));
  for (const std::size_t side : {0U, 1U}) touches[side].resize(steps), still[side].resize(steps);
  for (const PointTrack& track : found.tracks) {
    const auto side = static_cast<std::size_t>(track.point.side);
    const std::vector<Vec3> places = track_of(clip, track.point, found.leg_length);
    for (std::size_t f = 0; f < steps; ++f) {
      const Vec3 step = places[f + 1] - places[f];
      if (std::hypot(step.x(), step.z()) < kHeldStep * found.leg_length) still[side][f] = 1;
    }
  }
  for (const Stay& stay : found.stays) {
    const SolePoint& point = found.tracks[static_cast<std::size_t>(stay.track)].point;
    if (point.part == FootPart::tip) continue;
    const double last = std::min(std::floor(stay.end * clip.rate), static_cast<double>(steps));
    for (double f = std::ceil(stay.start * clip.rate); f < last; ++f) {
      touches[static_cast<std::size_t>(point.side)][static_cast<std::size_t>(f)] = 1;
    }
  }
  const auto few = std::max(kFewSteps, static_cast<std::size_t>(kFewMissedFor * clip.rate));
  std::size_t all = 0, missed = 0;
  for (const std::size_t side : {0U, 1U}) {
    for (std::size_t from = 0, to = 0; from < steps; from = ++to) {
      int held = 0;
      while (to < steps && touches[side][to]) held += still[side][to++];
      if (to - from < kFewSteps) continue;
      all += to - from;
      if (held >= kHeldPart * static_cast<double>(to - from)) continue;
      if (to - from > few) return false;
      missed += to - from;
    }
  }
  return all > 0 && static_cast<double>(missed) <= kMissedPart * static_cast<double>(all);
}

// Plants feet by given contacts.
class Planter {
 public:
  Planter(const Clip& clip, const RoleMap& roles, const plant::PlantedBody& body,
          const std::optional<std::span<const Contact>>& contacts)
      : clip_(clip), roles_(roles), body_(body), contacts_(contacts) {}

  // `more` stays are those that only the planted feet showed.
  Result<PlantedFeet> plant(FoundContacts found, const std::vector<Stay>& more) const {
    PlantedFeet planted;
    if (!contacts_) planted.warnings = found.warnings;
    const auto captured = stays_in(clip_, found, more, {});
    if (std::ranges::all_of(captured, [](const plant::Footing& f) { return f.stays.empty(); })) {
      return none();
    }
    planted.clip = clip_;
    note_stays(body_, captured, captured, planted);
    if (planted.drift_before <= plant::kMaxDrift * body_.leg_length) return planted;
    auto footings = captured;
    const double pelvis_jitter = plant::pelvis_jitter(body_, clip_);
    // Twice: places are known better once the body is steady.
    for (int round = 0; round < 2; ++round) {
      std::vector<plant::KnownCurve> shifts;
      for (std::size_t i = 0; i < footings.size(); ++i) {
        shifts.push_back(plant::needed_shift(planted.clip, body_, body_.legs[i], footings[i]));
      }
      const double jitter = plant::steady(body_, shifts, pelvis_jitter, planted.clip);
      planted.body_steadied = std::hypot(planted.body_steadied, jitter);
      if (!contacts_ && jitter > kShakes * body_.leg_length) {
        auto again = find_contacts(planted.clip, roles_);
        if (!again) return std::move(again).error();
        found = std::move(*again);
      }
      footings = stays_in(planted.clip, found, more, captured);
    }
    move_legs(footings, planted);
    planted.stays.clear();
    planted.drift_before = planted.drift_after = 0;
    note_stays(body_, captured, footings, planted);
    return planted;
  }

  // Feet that have been planted, as they are.
  PlantedFeet leave(const FoundContacts& found) const {
    PlantedFeet planted;
    planted.clip = clip_;
    planted.warnings = found.warnings;
    const auto footings = stays_in(clip_, found, {}, {});
    note_stays(body_, footings, footings, planted);
    planted.drift_before = planted.drift_after = 0;
    for (FixedStay& stay : planted.stays) {
      stay.drift_before = stay.drift_after = level_drift(clip_, stay);
      if (stay.point.part == FootPart::tip) continue;
      planted.drift_before = planted.drift_after = std::max(planted.drift_after, stay.drift_after);
    }
    return planted;
  }

  // Lets feet roll in what is left of stances beside the stays, which do not change.
  void roll(const FoundContacts& found, bool held, PlantedFeet& planted) const {
    const std::vector<Keytime> keytimes = find_gait(planted.clip, roles_, found).keytimes;
    auto footings = stays_in(planted.clip, found, {}, {});
    for (std::size_t i = 0; i < footings.size(); ++i) {
      // What was fixed stays, if it is found again or not.
      for (const FixedStay& stay : planted.stays) {
        if (stay.point.side != body_.legs[i].side) continue;
        const std::size_t point = footings[i].index_of(stay.point.part);
        if (point == footings[i].parts.size()) continue;
        auto& stay_at = footings[i].stay_at[point];
        std::fill(stay_at.begin() + stay.first, stay_at.begin() + stay.last + 1, 0);
      }
      const auto stances = stance_times(keytimes, body_.legs[i].side);
      plant::find_rolls(stances, planted.clip.rate, body_.leg_length, footings[i]);
    }
    if (!held && plant::slide_of(footings) > plant::kMaxDrift * body_.leg_length) {
      std::vector<plant::FootPath> paths;
      for (std::size_t i = 0; i < footings.size(); ++i) {
        paths.push_back(plant::rolling_path(planted.clip, body_, body_.legs[i], footings[i]));
      }
      finish(paths, planted);
    }
    for (std::size_t i = 0; i < footings.size(); ++i) {
      note_rolls(body_.legs[i], footings[i], planted);
    }
  }

  // Drift of heels and balls in stays found on planted feet, metres.
  double drift_in(const Clip& planted, const FoundContacts& found) const {
    double drift = 0;
    for (const plant::Footing& footing : stays_in(planted, found, {}, {})) {
      for (const FixedStay& stay : footing.stays) {
        if (stay.point.part == FootPart::tip) continue;
        const auto& track = footing.tracks[footing.index_of(stay.point.part)];
        drift = std::max(drift, plant::drift_of(track, stay.first, stay.last));
      }
    }
    return drift;
  }

 private:
  std::vector<plant::Footing> stays_in(const Clip& clip, const FoundContacts& found,
                                       const std::vector<Stay>& more,
                                       const std::vector<plant::Footing>& before) const {
    std::vector<Stay> stays = found.stays;
    stays.insert(stays.end(), more.begin(), more.end());
    return plant::fix_stays(clip, body_, stays, found.tracks, contacts_, before);
  }

  Error none() const {
    return Error(
        "plant-contacts", "no heel, ball or toe stands at any frame, so nothing can be planted",
        contacts_
            ? "no contact of a foot is given; remove the file to have them found"
            : "does the character walk in place (krok-edit --game-loop plants that), float, or "
              "jitter? krok-keys shows and edits "
              "contacts, krok-edit --filter smooths");
  }

  void move_legs(const std::vector<plant::Footing>& footings, PlantedFeet& planted) const {
    std::vector<plant::FootPath> paths;
    for (std::size_t i = 0; i < footings.size(); ++i) {
      paths.push_back(plant::foot_path(planted.clip, body_, body_.legs[i], footings[i]));
    }
    finish(paths, planted);
  }

  void finish(const std::vector<plant::FootPath>& paths, PlantedFeet& planted) const {
    const std::vector<double> lowered = plant::lowering(planted.clip, body_, paths);
    planted.out_of_reach = plant::apply(body_, paths, lowered, planted.clip);
    planted.pelvis_lowered += *std::ranges::max_element(lowered);
    if (planted.out_of_reach > 0) {
      planted.warnings.push_back(reach_warning(planted.out_of_reach, clip_));
    }
  }

  const Clip& clip_;
  const RoleMap& roles_;
  const plant::PlantedBody& body_;
  const std::optional<std::span<const Contact>>& contacts_;
};

// One pass, and whether it left the clip as it is.
struct Pass {
  PlantedFeet planted;
  bool unchanged = false, held = false;
};

Result<Pass> plant_once(const Clip& clip, const RoleMap& roles,
                        const std::optional<std::span<const Contact>>& contacts) {
  const auto body = plant::find_body(clip, roles);
  if (!body) return body.error();
  const auto found = find_contacts(clip, roles);
  if (!found) return found.error();
  const Planter planter(clip, roles, *body, contacts);
  const double max_drift = plant::kMaxDrift * body->leg_length;
  const bool rolled = is_held(clip, *found), held = rolled && !contacts;
  std::vector<Stay> more;
  auto planted = held ? Result<PlantedFeet>(planter.leave(*found)) : planter.plant(*found, more);
  for (int round = 1; !held && !contacts && planted && round < kRounds; ++round) {
    const auto shown = find_contacts(planted->clip, roles);
    if (!shown) return shown.error();
    if (planter.drift_in(planted->clip, *shown) <= max_drift) break;
    more.insert(more.end(), shown->stays.begin(), shown->stays.end());
    planted->clip = {};  // as large as the motion, and made anew
    planted = planter.plant(*found, more);
  }
  if (!planted) return std::move(planted).error();
  if (!contacts) {
    for (Diagnostic& warning : missed_stances(clip, roles, *found, planted->stays)) {
      planted->warnings.push_back(std::move(warning));
    }
  }
  const bool unchanged = planted->drift_before <= max_drift;
  return Pass{*std::move(planted), held || unchanged, rolled && (held || unchanged)};
}

// Measures the drifts before on the clip that was captured.
void measure_before(const Clip& clip, PlantedFeet& planted) {
  planted.drift_before = 0;
  for (FixedStay& stay : planted.stays) {
    std::vector<Vec3> track;
    for (int f = stay.first; f <= stay.last; ++f) {
      track.push_back(joint_at(clip, f, stay.point.joint) * stay.point.offset);
    }
    stay.drift_before = plant::drift_of(track, 0, stay.last - stay.first);
    if (stay.point.part == FootPart::tip) continue;
    planted.drift_before = std::max(planted.drift_before, stay.drift_before);
  }
}

// Rolls come last: they begin beside stays.
void roll_feet(const Clip& clip, const RoleMap& roles,
               const std::optional<std::span<const Contact>>& contacts, bool held,
               PlantedFeet& planted) {
  const auto body = plant::find_body(planted.clip, roles);
  const auto found = find_contacts(planted.clip, roles);
  if (!body || !found) return;
  Planter(planted.clip, roles, *body, contacts).roll(*found, held, planted);
  for (FixedStay& roll : planted.rolls) {
    roll.drift_before = level_drift(clip, roll);
    planted.roll_before = std::max(planted.roll_before, roll.drift_before);
  }
}

void measure_stances(const RoleMap& roles, PlantedFeet& planted) {
  const auto found = find_contacts(planted.clip, roles);
  if (!found) return;
  const std::vector<Keytime> keytimes = find_gait(planted.clip, roles, *found).keytimes;
  int all = 0, held = 0;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    std::vector<std::uint8_t> holds(static_cast<std::size_t>(planted.clip.frame_count()), 0);
    for (const auto* stays : {&planted.stays, &planted.rolls}) {
      for (const FixedStay& stay : *stays) {
        if (stay.point.side != side) continue;
        const int end = std::min(stay.last + 1, planted.clip.frame_count());
        std::fill(holds.begin() + stay.first, holds.begin() + std::max(stay.first, end), 1);
      }
    }
    for (const StanceTimes& stance : stance_times(keytimes, side)) {
      const int last = static_cast<int>(std::floor(stance.off * planted.clip.rate));
      for (int f = static_cast<int>(std::ceil(stance.strike * planted.clip.rate)); f <= last; ++f) {
        ++all;
        held += holds[static_cast<std::size_t>(f)];
      }
    }
  }
  if (all > 0) planted.stance_share = static_cast<double>(held) / all;
}

}  // namespace

Result<PlantedFeet> plant_feet(const Clip& clip, const RoleMap& roles,
                               std::optional<std::span<const Contact>> contacts) {
  if (Status status = check(clip); !status) return std::move(status).error();
  auto first = plant_once(clip, roles, contacts);
  if (!first) return std::move(first).error();
  PlantedFeet planted = std::move(first->planted);
  bool unchanged = first->unchanged;
  for (int pass = 1; !unchanged && pass < kPasses; ++pass) {
    auto next = plant_once(planted.clip, roles, contacts);
    if (!next) break;  // no stay is left that would be found
    unchanged = next->unchanged;
    if (unchanged) break;
    PlantedFeet& again = next->planted;
    again.pelvis_lowered += planted.pelvis_lowered;
    again.body_steadied = std::hypot(again.body_steadied, planted.body_steadied);
    again.out_of_reach = std::max(again.out_of_reach, planted.out_of_reach);
    again.warnings = std::move(planted.warnings);
    planted = std::move(again);
    measure_before(clip, planted);
  }
  roll_feet(clip, roles, contacts, first->held, planted);
  measure_stances(roles, planted);
  return planted;
}

}  // namespace krok
