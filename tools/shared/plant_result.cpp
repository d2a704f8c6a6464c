#include "tools/shared/plant_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"

namespace krok::cli {

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
  for (Contact& contact : keys.contacts) {
    const double middle = 0.5 * (contact.start + contact.end) * clip.rate;
    const int frame = std::clamp(static_cast<int>(std::lround(middle)), 0, clip.frame_count() - 1);
    contact.place =
        clip.frame_positions(frame)[static_cast<std::size_t>(contact.joint)].cast<double>();
  }
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
