#include "plant/plant_feet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contacts/contacts.h"
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
constexpr double kStands = 0.0005;

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
  Diagnostic warning;
  warning.severity = Severity::warning;
  warning.code = "plant-reach";
  warning.message = fmt::format(
      "in {} of {} frames a leg is too short to reach where its foot stands, so that the foot "
      "slides",
      frames, clip.frame_count());
  warning.hint = "are contacts marked where the foot does not stand?";
  return warning;
}

}  // namespace

Result<PlantedFeet> plant_feet(const Clip& clip, const RoleMap& roles,
                               std::optional<std::span<const Contact>> contacts) {
  if (Status status = check(clip); !status) return std::move(status).error();
  const auto body = plant::find_body(clip, roles);
  if (!body) return body.error();
  auto found = find_contacts(clip, roles);
  if (!found) return std::move(found).error();
  PlantedFeet planted;
  if (!contacts) planted.warnings = std::move(found->warnings);
  const auto captured = plant::fix_stays(clip, *body, found->stays, found->tracks, contacts);
  if (std::ranges::all_of(captured, [](const plant::Footing& f) { return f.stays.empty(); })) {
    return Error("plant-contacts",
                 "no heel, ball or toe stands at any frame, so nothing can be planted",
                 contacts ? "the contacts given are not of feet; remove the file to have them found"
                          : "does the figure walk in place, or float? krok-keys shows and edits "
                            "contacts");
  }
  planted.clip = clip;
  auto footings = captured;
  note_stays(*body, captured, captured, planted);
  if (planted.drift_before <= kStands * found->leg_length) return planted;
  const double pelvis_jitter = plant::pelvis_jitter(*body, clip);
  // Twice: places are known better once the body is steady.
  for (int round = 0; round < 2; ++round) {
    std::vector<plant::KnownCurve> shifts;
    for (std::size_t i = 0; i < footings.size(); ++i) {
      shifts.push_back(plant::needed_shift(planted.clip, *body, body->legs[i], footings[i]));
    }
    const double jitter = plant::steady(*body, shifts, pelvis_jitter, planted.clip);
    planted.body_steadied = std::hypot(planted.body_steadied, jitter);
    if (!contacts && jitter > kShakes * found->leg_length) {
      found = find_contacts(planted.clip, roles);
      if (!found) return std::move(found).error();
    }
    footings =
        plant::fix_stays(planted.clip, *body, found->stays, found->tracks, contacts, captured);
  }
  std::vector<plant::FootPath> paths;
  for (std::size_t i = 0; i < footings.size(); ++i) {
    paths.push_back(plant::foot_path(planted.clip, *body, body->legs[i], footings[i]));
  }
  const std::vector<double> lowered = plant::lowering(planted.clip, *body, paths);
  planted.out_of_reach = plant::apply(*body, paths, lowered, planted.clip);
  planted.pelvis_lowered = *std::ranges::max_element(lowered);
  planted.stays.clear();
  planted.drift_before = planted.drift_after = 0;
  note_stays(*body, captured, footings, planted);
  if (planted.out_of_reach > 0) {
    planted.warnings.push_back(reach_warning(planted.out_of_reach, clip));
  }
  return planted;
}

}  // namespace krok
