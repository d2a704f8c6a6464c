#pragma once

#include <span>

#include "core/result.h"
#include "formats/gltf/document_internal.h"
#include "formats/gltf/gltf_writer.h"
#include "scene/model.h"

// Private to this folder: morph targets and their weights beside whatever else moves a mesh.

namespace krok::gltf {

// Whether the targets and weights of the options, if there are any, fit the model. Codes:
// gltf-morphs and those of check(MorphSet).
Status check_morphs(const Model& model, const WriteOptions& options);

// Adds them to a mesh of the model and to the animation of its node. `attributes` are the mesh's.
Status add_morphs(Document& document, const Model& model,
                  const std::map<std::string, int>& attributes, int mesh, int node,
                  const WriteOptions& options);

}  // namespace krok::gltf
