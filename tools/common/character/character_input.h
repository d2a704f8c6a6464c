#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/registry/registry.h"
#include "roles/roles.h"
#include "scene/character.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "tools/common/tool.h"

namespace krok {

// A .character file with all that it names.
struct LoadedCharacter {
  Character character;
  Model model;  // its parts have the materials that the character gives them
  // Those that the parts have, in the order of the files; pictures with their bytes.
  std::vector<Material> materials;
  MorphSet morphs;             // under the names and in the order of the expressions; may be empty
  std::vector<float> weights;  // [targets] of `morphs`, where no motion of the face is given
  RoleMap roles;               // of the model's joints
};

// Reads a character. Every file that it names becomes an input of the run; each must lie in the
// folder tree of the character's own file (code path-outside). What does not fit together is an
// Error (codes character-part, character-joint, character-target, character-morphs,
// character-material), as is what a reader of one of the files refuses; a part whose material is in
// none of the files is warned of (code character-material).
Result<LoadedCharacter> load_character(const std::string& path, ToolContext& context);

// The same of a file that is open already.
Result<LoadedCharacter> load_character(const InputFile& input, ToolContext& context);

// Brings the model's mesh into the shape that it has where no motion of the face is given, and lets
// go of the morph targets.
void take_rest_shape(LoadedCharacter& loaded);

// A mesh on its skeleton, for whoever shows it without its face moving: a .model file, or a
// character as it is at rest, with its materials.
struct ShownModel {
  Model model;
  std::vector<Material> materials;
};

// Whether a file of this kind is one; load_shown_model() reads it.
bool is_shown_model(registry::Kind kind);
Result<ShownModel> load_shown_model(const InputFile& input, registry::Kind kind,
                                    ToolContext& context);

}  // namespace krok
