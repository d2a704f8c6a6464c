#include "plant/plant_feet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contacts/contacts.h"
#include "contacts/gait_keytimes.h"
#include "contacts/gait_metrics.h"
#include "plant/foot_paths_internal.h"
#include "plant/leg_pose_internal.h"
#include "plant/legs_internal.h"
#include "plant/stays_internal.h"
#include "plant/steady_internal.h"

namespace krok {

namespace {

// Of the leg: what jitter of the whole body is so large that contacts are found better without it.
constexpr double kShakes = 0.003;

// Of the leg: what heels and balls may move by while they stand for the clip to be left as it is.
constexpr double kStands = 0.0004;

// Feet that stand still show longer stays than feet that slide: times that these are looked at.
constexpr int kRounds = 3;

// Stances without a contact that are worth a warning: their number, and their part of all.
constexpr int kFewMissed = 2;
constexpr double kPartMissed = 0.2;

void note_stays(const plant::PlantedBody& body, const std::vector<plant::Footing>& captured,
                const std::vector<plant::Footing>& footings, PlantedFeet& planted) {
  for (std::size_t i = 0; i < body.legs.size(); ++i) {
    for (std::size_t p = 0; p < body.legs[i].points.size(); ++p) {
      const SolePoint& point = body.legs[i].points[p];
      std::vector<Vec3> after;
      after.reserve(static_cast<std::size_t>(planted.clip.frame_count()));
      for (int f = 0; f < planted.clip.frame_count(); ++f) {
        after.push_back(plant::joint_at(planted.clip, f, point.joint) * point.offset);
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

// Everything but the search for contacts, given once.
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
    if (planted.drift_before <= kStands * body_.leg_length) return planted;
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

  // What heels and balls move by in stays found on planted feet, metres.
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
        contacts_ ? "the contacts given are not of feet; remove the file to have them found"
                  : "does the character walk in place, float, or jitter? krok-keys shows and edits "
                    "contacts, krok-edit --filter smooths");
  }

  void move_legs(const std::vector<plant::Footing>& footings, PlantedFeet& planted) const {
    std::vector<plant::FootPath> paths;
    for (std::size_t i = 0; i < footings.size(); ++i) {
      paths.push_back(plant::foot_path(planted.clip, body_, body_.legs[i], footings[i]));
    }
    const std::vector<double> lowered = plant::lowering(planted.clip, body_, paths);
    planted.out_of_reach = plant::apply(body_, paths, lowered, planted.clip);
    planted.pelvis_lowered = *std::ranges::max_element(lowered);
    if (planted.out_of_reach > 0) {
      planted.warnings.push_back(reach_warning(planted.out_of_reach, clip_));
    }
  }

  const Clip& clip_;
  const RoleMap& roles_;
  const plant::PlantedBody& body_;
  const std::optional<std::span<const Contact>>& contacts_;
};

}  // namespace

Result<PlantedFeet> plant_feet(const Clip& clip, const RoleMap& roles,
                               std::optional<std::span<const Contact>> contacts) {
  if (Status status = check(clip); !status) return std::move(status).error();
  const auto body = plant::find_body(clip, roles);
  if (!body) return body.error();
  const auto found = find_contacts(clip, roles);
  if (!found) return found.error();
  const Planter planter(clip, roles, *body, contacts);
  std::vector<Stay> more;
  auto planted = planter.plant(*found, more);
  for (int round = 1; !contacts && planted && round < kRounds; ++round) {
    const auto shown = find_contacts(planted->clip, roles);
    if (!shown) return shown.error();
    if (planter.drift_in(planted->clip, *shown) <= kStands * body->leg_length) break;
    more.insert(more.end(), shown->stays.begin(), shown->stays.end());
    planted = planter.plant(*found, more);
  }
  if (!contacts && planted) {
    for (Diagnostic& warning : missed_stances(clip, roles, *found, planted->stays)) {
      planted->warnings.push_back(std::move(warning));
    }
  }
  return planted;
}

}  // namespace krok
