#include <algorithm>

#include "core/index.h"
#include "gait/walk_block_internal.h"

namespace krok::gait {

MotionKeys keys_of(const WalkParts& parts, std::span<const Stance> stances, double duration,
                   std::span<GroundedPrint> prints) {
  MotionKeys keys;
  for (std::size_t print = 0; print < stances.size(); ++print) {
    const Stance& stance = stances[print];
    const Leg& leg = parts.leg_of(print);
    GroundedPrint& grounded = prints[print];
    grounded.strike = stance.strike;
    grounded.off = std::min(stance.off, duration);
    const Transform flat = flat_foot(leg, grounded);
    const std::string side = name_of(grounded.side);
    if (print >= 2) keys.keytimes.push_back({stance.strike, side + "_strike"});
    if (stance.off < duration) keys.keytimes.push_back({stance.off, side + "_off"});
    keys.contacts.push_back(
        {leg.foot, stance.flat_from, std::min(stance.flat_to, duration), flat.position});
    if (leg.toes < 0) continue;
    const Transform toes = parts.walker.skeleton->reference_local(leg.toes);
    keys.contacts.push_back({leg.toes, stance.flat_from, grounded.off, flat * toes.position});
  }
  std::ranges::stable_sort(keys.contacts, [](const Contact& a, const Contact& b) {
    return a.start != b.start ? a.start < b.start : a.joint < b.joint;
  });
  std::ranges::stable_sort(keys.keytimes, {}, &Keytime::time);
  return keys;
}

}  // namespace krok::gait
