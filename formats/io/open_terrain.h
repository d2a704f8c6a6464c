#pragma once

#include <memory>
#include <string>

#include "formats/height_field/height_image.h"
#include "formats/io/inputs.h"
#include "terrain/terrain.h"

namespace krok::io {

// Opens the ground that a user names: a text such as "stairs:rise=17cm,run=29cm" (see
// terrain::from_spec()), a height field (EXR, PNG; its sidecar NAME.ground.json is used,
// `placement` goes before it), or a mesh (glTF, OBJ, or what is read through Assimp): all triangles
// of the displayed scene, as its nodes have them without an animation. Codes: those of the readers
// and of lib/terrain; ground-kind for other files and unknown texts; usage if `placement` is given
// for something else than a height field.
Result<std::unique_ptr<Terrain>> open_terrain(const std::string& ground,
                                              const height_field::Placement& placement,
                                              Inputs& inputs);

}  // namespace krok::io
