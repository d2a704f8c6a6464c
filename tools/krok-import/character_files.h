#pragma once

#include <string>
#include <vector>

#include "character/mesh.h"
#include "formats/container/packed_orientation.h"
#include "nodes/scene.h"
#include "scene/character.h"
#include "tools/cli/new_folders.h"
#include "tools/cli/output_set.h"

namespace krok::cli::import {

// Input of --character hero.character, which writes hero.model, hero.material with its images in
// hero_textures/, hero_morphs.exr, and hero.character, which refers to them. Files without content
// are not written.
struct CharacterFiles {
  std::string path;  // of the .character file
  OrientationEncoding orientation = OrientationEncoding::xyz;
  std::vector<float> weights;  // [targets] of the actor, at rest
  Provenance provenance;       // of model and morph targets
};

// Summary for the report.
struct AddedCharacter {
  Character character;
  std::size_t materials = 0, images = 0;
};

// Adds the files to `outputs`; `folder` is for the images. Parts of the actor get unique names and
// the names of the scene's materials. Codes: those of the writers.
Result<AddedCharacter> add_character(const CharacterFiles& files, const nodes::Scene& scene,
                                     character::SceneActor& actor, OutputSet& outputs,
                                     NewFolders& folder);

}  // namespace krok::cli::import
