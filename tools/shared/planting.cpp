#include "tools/shared/planting.h"

#include <fmt/format.h>

#include <cmath>

#include <algorithm>

#include <span>

#include "contacts/contacts.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "motion/hips_root.h"
#include "motion/travel.h"
#include "tools/shared/keys_sidecar.h"

namespace krok::cli {

namespace {

Json stay_json(const FixedStay& stay, const Clip& clip) {
  Json json;
  json["joint"] = clip.skeleton.names[static_cast<std::size_t>(stay.point.joint)];
  json["part"] = name_of(stay.point.part);
  json["side"] = name_of(stay.point.side);
  json["first_frame"] = stay.first;
  json["last_frame"] = stay.last;
  json["place"] = {stay.place.x(), stay.place.y(), stay.place.z()};
  json["drift_before"] = stay.drift_before;
  json["drift"] = stay.drift_after;
  return json;
}

}  // namespace

Result<std::optional<std::vector<Contact>>> read_planting_contacts(const std::string& contacts,
                                                                   const std::string& motion_path,
                                                                   const FrameSource& motion,
                                                                   ToolContext& context) {
  std::optional<krok::keys::Sidecar> sidecar;
  if (contacts == "auto") {
    auto beside = read_keys_beside(motion_path, motion, context);
    if (!beside) return beside.error();
    sidecar = std::move(*beside);
  } else if (contacts != "find") {
    auto file = read_keys_file(contacts, motion, context);
    if (!file) return file.error();
    sidecar = std::move(*file);
  }
  if (!sidecar) return std::optional<std::vector<Contact>>();
  return std::optional(std::move(sidecar->keys.contacts));
}

Result<PlantedFeet> plant(const Clip& clip, const RoleMap& roles,
                          const std::optional<std::vector<Contact>>& contacts) {
  if (const auto& removed = clip.provenance.removed_root_motion) {
    // In place, feet on the ground move with it: the motion is planted as it travels.
    const int carrier = carrying_joint(roles);
    const Clip travelling = carried_along(clip, carrier, *removed);
    auto there = contacts;
    if (there) place_contacts(travelling, *there);
    auto planted = plant(travelling, roles, there);
    if (!planted) return planted;
    planted->clip =
        carried_along(planted->clip, carrier, {-removed->velocity, -removed->turn_rate});
    planted->clip.provenance = clip.provenance;
    return planted;
  }
  std::optional<std::span<const Contact>> given;
  if (contacts) given = *contacts;
  return plant_feet(clip, roles, given);
}

PlantedFrames plant_frames(const FrameSource& motion, const RoleMap& roles,
                           const std::optional<std::vector<Contact>>& contacts,
                           const std::optional<RootMotion>& removed, ToolContext& context) {
  const auto plant_part = [roles](const Clip& part, const auto& given) {
    return plant(part, roles, given);
  };
  return plant_long_take(motion, contacts, removed, thread_count(context.jobs), plant_part);
}

Json planting_json(const PlantedFeet& planted, bool contacts_given) {
  Json json;
  json["contacts"] = contacts_given ? "file" : "found";
  json["drift_before"] = planted.drift_before;
  json["drift"] = planted.drift_after;
  json["pelvis_lowered"] = planted.pelvis_lowered;
  json["body_steadied"] = planted.body_steadied;
  json["frames_out_of_reach"] = planted.out_of_reach;
  if (planted.stance_share) json["stance_share"] = *planted.stance_share;
  json["stays"] = Json::array();
  for (const FixedStay& stay : planted.stays)
    json["stays"].push_back(stay_json(stay, planted.clip));
  json["roll_slide_before"] = planted.roll_before;
  json["roll_slide"] = planted.roll_after;
  json["rolls"] = Json::array();
  for (const FixedStay& roll : planted.rolls)
    json["rolls"].push_back(stay_json(roll, planted.clip));
  return json;
}

std::string planting_line(const PlantedFeet& planted) {
  if (planted.drift_after == planted.drift_before && planted.rolls.empty() &&
      planted.pelvis_lowered == 0 && planted.body_steadied == 0) {
    return fmt::format("feet stay in {} already, heels and balls drift by up to {}: left as it is",
                       counted(planted.stays.size(), "stay"), millimetres(planted.drift_after));
  }
  std::string line = fmt::format("feet planted in {}", counted(planted.stays.size(), "stay"));
  if (planted.stance_share) {
    line += fmt::format(", {:.0f} % of the time from strike to toe-off",
                        std::floor(100 * *planted.stance_share));
  }
  line += fmt::format(": heels and balls drift by up to {} instead of {}",
                      millimetres(planted.drift_after), millimetres(planted.drift_before));
  if (!planted.rolls.empty()) {
    line += fmt::format(", what rolls before and after by up to {} instead of {}",
                        millimetres(planted.roll_after), millimetres(planted.roll_before));
  }
  double tips = 0;  // about which a foot turns
  for (const FixedStay& stay : planted.stays) {
    if (stay.point.part == FootPart::tip) tips = std::max(tips, stay.drift_after);
  }
  if (tips > 5e-4) line += fmt::format(", toe tips by up to {}", millimetres(tips));
  if (planted.pelvis_lowered > 5e-4) {
    line += fmt::format("; pelvis lowered by up to {}", millimetres(planted.pelvis_lowered));
  }
  if (planted.body_steadied > 5e-4) {
    line += fmt::format("; jitter of {} taken out of the body", millimetres(planted.body_steadied));
  }
  return line;
}

Result<PlantDrift> plant_result(Clip& clip, MotionKeys& keys, const RoleMap& roles,
                                ToolContext& context) {
  std::optional<std::span<const Contact>> contacts;
  if (!keys.contacts.empty()) contacts = keys.contacts;
  auto planted = plant_feet(clip, roles, contacts);
  if (!planted && planted.error().code == "plant-contacts") {
    context.warn(planted.error().code, planted.error().message, planted.error().hint);
    return PlantDrift{};
  }
  if (!planted) return std::move(planted).error();
  context.diagnose(planted->warnings);
  planted->clip.provenance = std::move(clip.provenance);
  clip = std::move(planted->clip);
  place_contacts(clip, keys.contacts);
  return PlantDrift{planted->drift_before, planted->drift_after};
}

Json to_json(const PlantDrift& drift) {
  return {{"drift_before", drift.before}, {"drift", drift.after}};
}

std::string text_of(const PlantDrift& drift) {
  return fmt::format("feet planted: largest drift {} mm instead of {} mm",
                     readable(1e3 * drift.after, 3), readable(1e3 * drift.before, 3));
}

}  // namespace krok::cli
