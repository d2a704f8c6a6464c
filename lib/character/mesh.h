#pragma once

#include <vector>

#include "capture/convention_choice.h"
#include "character/rig.h"
#include "character/sampling.h"
#include "core/result.h"
#include "scene/character.h"

// Converts the meshes of a scene to one model on a rig.

namespace krok::character {

// Its model is in the rig's reference pose and Krok's frame, with the rig's skeleton. Of the rest
// of an Actor it has the morph targets.
struct SceneActor : Actor {
  // The source of each target's weight: a node whose mesh has the target, and its index there.
  struct WeightSource {
    int node = 0;
    int target = 0;
  };
  std::vector<WeightSource> weight_sources;  // [targets]

  std::vector<int> part_materials;  // [parts] of the model, in the scene's materials; -1 for none
};

struct SceneActorOptions {
  bool with_morphs = false;  // fill `morphs`
};

// All triangles of the displayed scene whose mesh is bound by one of the rig's skins, or is below
// one of its joints without a skin (then bound rigidly to that joint). Other meshes, points and
// lines are skipped and reported (code scene-mesh). One part per primitive, named after its
// material, or after its mesh if it has none. Successive primitives of a mesh with identical
// vertices keep sharing them.
//
// Vertices are transformed to the reference pose by sum_j w_j F_j B_j v, which for a skin that
// agrees with the bind pose is one transform for all. Missing normals are computed from the
// triangles if other primitives have normals; tangents are kept if all primitives have them.
//
// Targets of the same name in several meshes are merged if their weights are the same without
// animation and in all animations; otherwise names are made unique. Unnamed targets are named after
// the mesh, with a number. Vertices of meshes without a target do not move in it.
//
// An Error if vertices are not finite (scene-value), there are too many morph targets
// (scene-morphs: more than 50 million vertices in all targets together) or many nodes share a mesh
// (scene-instances: over a million vertices that are 20 times the file's; a warning from twice on).
Result<SceneActor> make_actor(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                              const Rig& rig, const Conversion& conversion,
                              const SceneActorOptions& options, Diagnostics& diagnostics);

// The weights of an actor's targets over time; animation -1: the weights without animation. An
// Error (code scene-too-long) for more than 100 million weights in total.
Result<MorphWeights> make_weights(const SceneActor& actor, const nodes::Evaluator& evaluator,
                                  int animation, const Sampling& sampling);

}  // namespace krok::character
