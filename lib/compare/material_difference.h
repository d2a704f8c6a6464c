#pragma once

#include <string>
#include <vector>

#include "scene/material.h"

namespace krok::compare {

// Differences in material properties, one phrase each: "base colour 1, 0, 0, 1 and 0, 0, 1, 1",
// "another normal texture". Empty if there are none. Numbers may differ by `tolerance`; images are
// equal if their bytes are, whatever their source; material names are ignored.
std::vector<std::string> differences(const Material& first, const Material& second,
                                     double tolerance);

}  // namespace krok::compare
