#pragma once

#include <span>
#include <string>
#include <vector>

#include "scene/material.h"
#include "scene/material_parameter.h"

namespace krok::compare {

// Differences in material properties, one phrase each: "base colour 1, 0, 0, 1 and 0, 0, 1, 1",
// "another normal texture". Empty if there are none. Numbers may differ by `tolerance`; images are
// equal if their bytes are, whatever their source; material names are ignored.
std::vector<std::string> differences(const Material& first, const Material& second,
                                     double tolerance);

// The same for parameters of glTF extensions. A property that only one has is compared with its
// default; textures by image, wrapping and texture coordinate set.
std::vector<std::string> differences(std::span<const MaterialParameter> first,
                                     std::span<const MaterialParameter> second, double tolerance);

}  // namespace krok::compare
