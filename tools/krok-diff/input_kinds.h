#pragma once

#include <string>

#include "core/file.h"
#include "core/result.h"

// What krok-diff can compare.

namespace krok::diff {

enum class InputKind {
  motion,  // .anim, or a capture
  model,
  camera,
  gltf,    // of both forms
  points,  // a point cache, .pc2
  morphs,  // morph targets in an OpenEXR file
};

// "a motion"
std::string description(InputKind kind);

// The word for it in reports: "anim", "model", "cam", "gltf", "pc2", "morphs".
const char* word_of(InputKind kind);

// From the file's content, or its name where that shows nothing. Code diff-kind.
Result<InputKind> kind_of(const InputFile& file);

}  // namespace krok::diff
