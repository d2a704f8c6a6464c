#include "contacts/contacts.h"
#include "motion/cut.h"
#include "motion/place.h"
#include "motion/travel.h"
#include "tools/krok-edit/steps.h"
#include "tools/shared/planting.h"

namespace krok::cli::edit {

Status plant(const Options& options, ToolContext& context, Edit& edit) {
  if (!options.plant) return {};
  auto planted = cli::plant(edit.clip, edit.roles, edit.contacts);
  if (!planted) return planted.error();
  context.diagnose(planted->warnings);
  Json metrics = planting_json(*planted, edit.contacts.has_value());
  std::string line = planting_line(*planted);
  edit.clip = std::move(planted->clip);
  edit.note("plant", std::move(metrics), std::move(line));
  return {};
}

Status plant_loop(const Options& options, const Edit& edit, Looped& looped) {
  if (!options.plant) return {};
  constexpr int kCycles = 3;
  const auto cycles = repeated(looped.clip, looped.displacement, kCycles);
  if (!cycles) return cycles.error();
  const auto moving = travelling(*cycles, edit.carrier);
  auto contacts = find_contacts(moving ? *moving : *cycles, edit.roles);
  if (!contacts) return contacts.error();
  // A loop in which no foot is in contact has nothing to hold.
  const auto planted = cli::plant(*cycles, edit.roles, std::move(contacts->contacts));
  if (!planted) return {};
  const int period = looped.clip.frame_count() - 1;
  Clip middle = cut(planted->clip, period, 2 * period);
  move_clip(looped.displacement.inverse(), middle);
  // Closes what is left at the seam.
  const LoopOptions closing{
      options.loop_blend.seconds(edit.clip.rate), LoopEnd::closed,
      looped.turn == 0 ? LoopTurn::straighten : LoopTurn::keep,
      looped.displacement.position.y() == 0 ? LoopClimb::level : LoopClimb::keep};
  auto closed = loop(middle, edit.carrier, closing);
  if (!closed) return closed.error();
  looped.clip = std::move(closed->clip);
  looped.displacement = closed->displacement;
  return {};
}

}  // namespace krok::cli::edit
