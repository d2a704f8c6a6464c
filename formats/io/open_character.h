#pragma once

#include <string>
#include <vector>

#include "formats/io/inputs.h"
#include "formats/registry/registry.h"
#include "roles/roles.h"
#include "scene/character.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/morph_set.h"

namespace krok::io {

// A .character file with all files that it names.
struct LoadedCharacter {
  Character character;
  Model model;  // its parts have the materials that the character assigns
  // Those that parts use, in the order of the files, with their images.
  std::vector<Material> materials;
  MorphSet morphs;             // named and ordered as the expressions; may be empty
  std::vector<float> weights;  // [targets] of `morphs`, where no motion of the face is given
  RoleMap roles;               // of the model's joints
};

// Reads a character. Files that it names are opened by `inputs`; each must be in the folder tree of
// the character's own file (code path-outside).
//
// Errors: what does not match (codes character-part, character-joint, character-target,
// character-morphs, character-material), and those of the readers of its files. A part whose
// material is in none of the files is a warning (character-material).
Result<LoadedCharacter> open_character(const std::string& path, Inputs& inputs);
// The same of a file that is open already.
Result<LoadedCharacter> open_character(const InputFile& file, Inputs& inputs);

// Applies the morph weights that hold without a motion of the face to the model's mesh, and frees
// the morph targets.
void apply_rest_weights(LoadedCharacter& loaded);

// A mesh on its skeleton, for callers that show it without animating its face: a .model file, or a
// character at rest with its materials.
struct ShownModel {
  Model model;
  std::vector<Material> materials;
};

// Whether files of this kind hold one.
bool is_shown_model(registry::Kind kind);
// Error shown-model-kind for other files.
Result<ShownModel> open_shown_model(const InputFile& file, Inputs& inputs);

}  // namespace krok::io
