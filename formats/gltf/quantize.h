#pragma once

#include "scene/model.h"

namespace krok::gltf {

// What a quantized file holds of a model (WriteOptions::quantized), as a viewer decodes it, to
// measure what it loses: positions in steps of the longest side of the mesh's box / 65535 (off by
// up to half a step along each axis), weights in steps of 1 / 65535.
Model quantized(const Model& model);

// The largest distance of a vertex from where it was, in the reference pose: metres.
double quantization_bound(const Model& model);

}  // namespace krok::gltf
