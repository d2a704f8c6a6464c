#pragma once

#include <string>

#include "core/file.h"
#include "core/result.h"

// File types that krok-diff can compare.

namespace krok::cli::diff {

enum class InputKind {
  motion,  // .anim, or a capture
  model,
  mesh,  // .obj
  camera,
  gltf,    // .gltf and .glb
  points,  // a point cache, .pc2
  morphs,  // morph targets in an OpenEXR file
};

// "a motion"
std::string description(InputKind kind);

// The type's name in reports: "anim", "model", "obj", "cam", "gltf", "pc2", "morphs".
const char* word_of(InputKind kind);

// Detected from the content, or else from the file name. Code diff-kind.
Result<InputKind> kind_of(const InputFile& file);

}  // namespace krok::cli::diff
