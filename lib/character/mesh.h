#pragma once

#include <vector>

#include "capture/convention_choice.h"
#include "character/rig.h"
#include "character/sampling.h"
#include "core/result.h"
#include "scene/model.h"
#include "scene/morph_set.h"

// The meshes of a scene as one model on a rig.

namespace krok::character {

struct Actor {
  Model model;      // in the rig's reference pose and Krok's frame; its skeleton is the rig's
  MorphSet morphs;  // of the model's vertices; no targets where the scene has none

  // Where each target's weight comes from: a node whose mesh has it, and its place there.
  struct WeightSource {
    int node = 0;
    int target = 0;
  };
  std::vector<WeightSource> weight_sources;  // [targets]

  std::vector<int> part_materials;  // [parts] of the model, in the scene's materials; -1 for none
};

struct ActorOptions {
  bool with_morphs = false;  // fill `morphs`
};

// All triangles of the scene that is shown whose mesh is bound by one of the rig's skins, or hangs
// without a skin on one of its joints (then each vertex follows that joint alone). Meshes elsewhere
// are left out and reported (code scene-mesh), as are points and lines. One part a primitive, named
// as its material, or as its mesh if it has none. Primitives of a mesh that have the very same
// vertices, one after the other, keep sharing them.
//
// Vertices are brought into the reference pose by sum_j w_j F_j B_j v, which for a skin that agrees
// with the bind pose is one transform for all. Normals are made from the triangles for primitives
// that lack them where others have some; tangents are kept if all have them.
//
// Targets of one name in several meshes become one, if their weights are the same without animation
// and in all animations; names are made unique otherwise. Targets without a name get the mesh's and
// a number. Vertices of meshes without a target keep their place in it.
//
// An Error where vertices are not finite (scene-value) or morph targets are out of proportion
// (scene-morphs: more than 50 million vertices in all targets together).
Result<Actor> make_actor(const nodes::Scene& scene, const nodes::Evaluator& evaluator,
                         const Rig& rig, const Conversion& conversion, const ActorOptions& options,
                         Diagnostics& diagnostics);

// The weights of a figure's targets over time; animation -1: as they are without. An Error (code
// scene-too-long) for more than 100 million weights in all.
Result<MorphWeights> make_weights(const Actor& actor, const nodes::Evaluator& evaluator,
                                  int animation, const Sampling& sampling);

}  // namespace krok::character
