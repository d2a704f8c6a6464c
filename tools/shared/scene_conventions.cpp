#include "tools/shared/scene_conventions.h"

#include "character/motion.h"
#include "character/sampling.h"
#include "character/space.h"

namespace krok::cli {

Result<Conventions> scene_conventions(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                                      const character::Rig* rig, const RoleMap& roles,
                                      int animation, const GivenConventions& given) {
  constexpr int kMaxSamples = 200;
  std::vector<Vec3> samples;
  if (rig != nullptr && animation >= 0) {
    Diagnostics reported_elsewhere;
    const auto& keys = scene.animations[static_cast<std::size_t>(animation)];
    const auto sampling = character::choose_sampling(keys, {}, reported_elsewhere);
    if (!sampling) return sampling.error();
    samples =
        character::sample_positions(evaluator, *rig, animation, sampling->sampling, kMaxSamples);
  }
  return character::find_conventions(scene.space, rig, roles, samples, given);
}

}  // namespace krok::cli
