#include <fmt/format.h>

#include "character/mesh.h"

#include "core/index.h"

namespace krok::character {

Result<MorphWeights> make_weights(const SceneActor& actor, const nodes::Evaluator& evaluator,
                                  int animation, const Sampling& sampling) {
  constexpr std::size_t kMax = 100'000'000;
  const std::size_t targets = actor.weight_sources.size();
  if (targets > 0 && at(sampling.frames) > kMax / targets) {
    return Error("scene-too-long",
                 fmt::format("{} frames of {} morph weights exceed the limit of 100 million",
                             sampling.frames, targets),
                 "use --rate N for a lower frame rate");
  }
  MorphWeights weights;
  weights.rate = sampling.rate;
  weights.names = actor.morphs.names;
  weights.values.reserve(at(sampling.frames) * targets);
  nodes::Evaluation state;
  for (int frame = 0; frame < sampling.frames; ++frame) {
    evaluator.place_nodes(animation, sampling.time(frame), state);
    for (const SceneActor::WeightSource& source : actor.weight_sources) {
      weights.values.push_back(
          static_cast<float>(state.node_weights[at(source.node)][at(source.target)]));
    }
  }
  return weights;
}

}  // namespace krok::character
