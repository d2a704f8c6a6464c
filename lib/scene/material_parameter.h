#pragma once

#include <string>
#include <vector>

#include "scene/material.h"

namespace krok {

// A property of a glTF material that Material has no member for, kept for comparing files.
struct MaterialParameter {
  std::string name;            // "KHR_materials_clearcoat, clearcoatFactor"
  std::vector<double> values;  // if it is a number or several
  Texture texture{};           // if it is one
  std::string text{};          // of any other property: its JSON
};

}  // namespace krok
