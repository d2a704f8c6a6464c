#pragma once

#include <span>

#include "core/result.h"
#include "formats/gltf/document_internal.h"
#include "formats/gltf/gltf_writer.h"
#include "scene/model.h"

// Private to this folder: writes morph targets and their weights.

namespace krok::gltf {

// Whether the options' targets and weights, if any, match the model. Codes: gltf-morphs and those
// of check(MorphSet).
Status check_morphs(const Model& model, const WriteOptions& options);

// Adds them to the model's meshes, which have `attributes`, and to the animation of their nodes.
Status add_morphs(Document& document, const Model& model,
                  const std::map<std::string, int>& attributes,
                  std::span<const Document::MeshNode> meshes, const WriteOptions& options);

}  // namespace krok::gltf
