#pragma once

#include <vector>

#include "scene/material.h"

namespace krok::nodes {

// Gives materials that a file has without names, with names that Krok does not take (see is_name)
// or with the same ones names of their own: "material_3" for the fourth, "Skin_2" for the second
// called Skin.
void make_names_unique(std::vector<Material>& materials);

}  // namespace krok::nodes
