#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "math/types.h"

namespace krok {

// A character: the files needed to display and animate it, and what none of them stores. Paths are
// relative to the character file, use '/', and stay in its folder.
struct Character {
  static constexpr float kFurthest = 1e6f;
  static constexpr float kMaxWeight = 1000.0f;

  std::string name;                    // for display; may be empty
  std::string model;                   // mesh, skin and skeleton, a .model file
  std::vector<std::string> materials;  // .material files; material names are unique across them

  // Overrides the material of parts of the model.
  struct Part {
    std::string name;      // of one or several parts of the model
    std::string material;  // name of a material; empty for none
  };
  std::vector<Part> parts;  // names are unique

  // An eye position that moves with a joint.
  struct Eye {
    std::string name;                // "left"; unique, not empty
    std::string joint;               // of the model
    Vec3f position = Vec3f::Zero();  // metres, in the model's reference pose; +-kFurthest
  };
  std::vector<Eye> eyes;

  std::string morphs;  // morph targets of the model, a float EXR; empty for none

  // A morph target with a display name, and its weight while no face motion is given.
  struct Expression {
    std::string name;     // unique, not empty
    std::string target;   // in `morphs`; empty: the one with the expression's name
    float weight = 0.0f;  // +-kMaxWeight
  };
  std::vector<Expression> expressions;  // empty: all targets, at rest

  std::string role_map;  // joint roles (formats/role_map); empty: found by joint names
};

// Checks everything documented above that can be checked without reading the files. Code
// character-value.
Status check(const Character& character);

}  // namespace krok
