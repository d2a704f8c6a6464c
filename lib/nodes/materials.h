#pragma once

#include <vector>

#include "scene/material.h"

namespace krok::nodes {

// Makes material names valid (see is_name) and unique: a material without a name becomes
// "material_3" (the fourth), the second one named Skin becomes "Skin_2".
void make_names_unique(std::vector<Material>& materials);

}  // namespace krok::nodes
