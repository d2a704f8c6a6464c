#include "retarget/take_pool.h"

#include <algorithm>

#include "retarget/actor_view_internal.h"

namespace krok::retarget {

TakePool::TakePool(std::size_t takes, const RoleMap& roles)
    : frames_each_(
          static_cast<int>(std::max<std::size_t>(20'000 / std::max<std::size_t>(takes, 1), 4))),
      roles_(roles) {}

void TakePool::add(const Clip& take) {
  if (pool_.skeleton.empty()) pool_.skeleton = take.skeleton;
  const int count = std::min(take.frame_count(), frames_each_);
  for (int i = 0; i < count; ++i) {
    // The middles of equal parts.
    const auto f = static_cast<int>((2LL * i + 1) * take.frame_count() / (2LL * count));
    const auto positions = take.frame_positions(f);
    const auto orientations = take.frame_orientations(f);
    pool_.positions.insert(pool_.positions.end(), positions.begin(), positions.end());
    pool_.orientations.insert(pool_.orientations.end(), orientations.begin(), orientations.end());
  }
  if (has_stance_ || !begins_in_a_stance(take, roles_)) return;
  has_stance_ = true;
  const auto positions = take.frame_positions(0);
  const auto orientations = take.frame_orientations(0);
  pool_.positions.insert(pool_.positions.begin(), positions.begin(), positions.end());
  pool_.orientations.insert(pool_.orientations.begin(), orientations.begin(), orientations.end());
}

}  // namespace krok::retarget
