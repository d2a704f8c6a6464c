#pragma once

#include <string>

#include "formats/io/inputs.h"
#include "roles/roles.h"
#include "scene/character.h"

namespace krok::io {

// A .character file with all files that it names. The model's parts have the materials that the
// character assigns, materials are those that parts use, in the order of the files, morphs are
// named and ordered as the expressions.
struct LoadedCharacter : Actor {
  Character character;
  RoleMap roles;  // of the model's joints
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
void apply_rest_weights(Actor& actor);

struct ActorOptions {
  std::string clip = {};            // animation of a scene, a name or number; empty: the best
  bool every_clip = false;          // of scenes, without `clip`: all that move or pose joints
  bool with_mesh = true;            // of scenes, not the skeleton alone
  bool with_materials = true;       // of scenes with a mesh
  bool with_morphs = false;         // keep morph targets; otherwise faces are at rest
  bool with_motions = true;         // of scenes: the animation
  bool with_camera = false;         // take a file with a camera alone, which is refused otherwise
  bool with_stretches = false;      // otherwise joints that change scale are a warning
  bool rest_frame_is_note = false;  // as in MotionOptions
  bool with_weights = false;        // of scenes: the morph weights of animations
  bool stays_still = false;  // of scenes: warn of animations, and of a pose, that will not be shown
  // Of scenes: warn of cameras, lights and other nodes without a mesh, and of variants.
  bool keeps_mesh_alone = false;
};

// What a file holds, whatever it is: a motion with its skeleton, a model, a character, a camera, or
// the character of a scene with one of its animations, converted to Krok's frame as krok-import
// does.
//
// Errors: those of open_motion(), open_character(), open_scene() and the conversion.
Result<Actor> open_actor(const InputFile& file, Inputs& inputs, const ActorOptions& options = {});
Result<Actor> open_actor(const std::string& path, Inputs& inputs, const ActorOptions& options = {});

// All motions of a file: each animation of a scene that moves or poses joints, with its name; the
// one of any other file, without a name. Errors: those of open_motion().
Result<std::vector<Actor::Motion>> open_motions(const InputFile& file, Inputs& inputs);

}  // namespace krok::io
