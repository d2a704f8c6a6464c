#include <fmt/format.h>

#include "core/numbers.h"
#include "plant/plant_feet.h"
#include "tools/krok-edit/steps.h"

namespace krok::cli::edit {

namespace {

Json to_json(const FixedStay& stay, const Clip& clip) {
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

std::string millimetres(double metres) {
  return readable(metres * 1000, 3) + " mm";
}

}  // namespace

Status plant(const Options& options, ToolContext& context, Edit& edit) {
  if (!options.plant) return {};
  std::optional<std::span<const Contact>> contacts;
  if (edit.contacts) contacts = *edit.contacts;
  auto planted = plant_feet(edit.clip, edit.roles, contacts);
  if (!planted) return planted.error();
  context.diagnose(planted->warnings);
  Json stays = Json::array();
  for (const FixedStay& stay : planted->stays) stays.push_back(to_json(stay, edit.clip));
  Json metrics;
  metrics["contacts"] = edit.contacts ? "file" : "found";
  metrics["drift_before"] = planted->drift_before;
  metrics["drift"] = planted->drift_after;
  metrics["pelvis_lowered"] = planted->pelvis_lowered;
  metrics["body_steadied"] = planted->body_steadied;
  metrics["frames_out_of_reach"] = planted->out_of_reach;
  metrics["stays"] = std::move(stays);
  std::string line =
      fmt::format("feet planted in {}: largest drift {} instead of {}",
                  counted(static_cast<long long>(planted->stays.size()), "stay"),
                  millimetres(planted->drift_after), millimetres(planted->drift_before));
  if (planted->pelvis_lowered > 5e-4) {
    line += fmt::format("; pelvis lowered by up to {}", millimetres(planted->pelvis_lowered));
  }
  if (planted->body_steadied > 5e-4) {
    line +=
        fmt::format("; jitter of {} taken out of the body", millimetres(planted->body_steadied));
  }
  edit.clip = std::move(planted->clip);
  edit.note("plant", std::move(metrics), std::move(line));
  return {};
}

}  // namespace krok::cli::edit
