#pragma once

#include <string>
#include <vector>

#include "scene/material.h"

namespace krok::compare {

// What differs in how two surfaces look, a phrase each: "base colour 1, 0, 0, 1 and 0, 0, 1, 1",
// "another normal texture". Empty if nothing does. Numbers may differ by `tolerance`; pictures are
// the same if their bytes are, wherever they came from; names of materials do not count.
std::vector<std::string> differences(const Material& first, const Material& second,
                                     double tolerance);

}  // namespace krok::compare
