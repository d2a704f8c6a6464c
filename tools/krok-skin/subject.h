#pragma once

#include "core/result.h"
#include "scene/character.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "tools/common/tool.h"
#include "tools/krok-skin/options.h"

namespace krok::skinning {

// What is skinned: a mesh and the motion that moves it, on one skeleton, and how its shape changes.
struct Subject {
  Model model;                     // on the motion's skeleton, with triangles
  Clip clip;                       // the part that is wanted
  int first_frame = 0, every = 1;  // of the motion as read, for names of files

  std::vector<Material> materials;   // of the model's parts; of a character
  std::vector<Character::Eye> eyes;  // at joints of the model; of a character

  MorphSet morphs;       // without targets where there are none
  MorphWeights weights;  // at the frames of `clip`, for the targets of `morphs`; or none

  bool changes_shape() const { return !weights.values.empty(); }
};

// Reads the files that the options name. Codes: those of their readers, of bind_to() and
// chosen_range(), skin-empty-model, skin-morphs.
Result<Subject> load(const Options& options, ToolContext& context);

}  // namespace krok::skinning
