#include "methods.h"
#include "support/foot_skate.h"

namespace krok::bench {

Clip plain_locking(const Clip& clip, const RoleMap& roles, const std::vector<FixedStay>& stays) {
  Clip result = clip;
  const auto legs = test::legs_of(roles);
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (const std::size_t side : {0U, 1U}) {
      // Heels stand before balls in the list.
      for (const FixedStay& stay : stays) {
        if (static_cast<std::size_t>(stay.point.side) != side || f < stay.first || f > stay.last ||
            stay.point.part == FootPart::tip) {
          continue;
        }
        const Vec3 now = test::joint_of(clip, f, stay.point.joint) * stay.point.offset;
        (void)test::move_foot(result, f, legs[side], stay.place - now, true);
        break;
      }
    }
  }
  return result;
}

}  // namespace krok::bench
