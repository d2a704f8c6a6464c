#pragma once

#include "scene/model.h"
#include "scene/morph_set.h"

namespace krok::gltf {

// How exactly a quantized file holds vertices (WriteOptions::quantized).
struct Quantization {
  double position_step = 0;  // metres; or the longest side of the mesh's box / 65534, if larger
  int weight_bits = 16;      // steps of 1 / 255 (8), 1 / 65535 (16) or, if filtered, 2^-bits
  int coordinate_bits = 16;  // steps of 2^-bits if filtered, else of 1 / 65535
  bool filtered = false;     // through the filters of EXT_meshopt_compression; for compressed files
};

// What a quantized file holds of a model, as a viewer decodes it, to measure what it loses.
Model quantized(const Model& model, const Quantization& quantization);

// The same of its morph targets: `shown` is quantized() of the model.
MorphSet quantized(const MorphSet& morphs, const Model& model, const Model& shown,
                   const Quantization& quantization);

// The largest distance of a vertex from where it was, in the reference pose without morph targets:
// metres.
double quantization_bound(const Model& model, const Quantization& quantization);

// The largest angle between a normal and what the file holds of it: radians.
double normal_error(const Model& model, const Quantization& quantization);

}  // namespace krok::gltf
