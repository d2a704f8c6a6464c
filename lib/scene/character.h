#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "math/types.h"

namespace krok {

// What belongs together to show and to animate a figure: the files that hold it, and what none of
// them says. Paths are relative to the character's own file, with '/', and stay in its folder.
struct Character {
  static constexpr float kFurthest = 1e6f;
  static constexpr float kMaxWeight = 1000.0f;

  std::string name;                    // for people; may be empty
  std::string model;                   // mesh, skin and skeleton, a .model file
  std::vector<std::string> materials;  // .material files; none has a material of another's name

  // What the model's parts of a name look like, where it is not as the model says.
  struct Part {
    std::string name;      // of one or several parts of the model
    std::string material;  // of one of the materials; empty for none
  };
  std::vector<Part> parts;  // each name once

  // A place that moves with a joint.
  struct Eye {
    std::string name;                // "left"; unique, not empty
    std::string joint;               // of the model
    Vec3f position = Vec3f::Zero();  // metres, in the model's reference pose; +-kFurthest
  };
  std::vector<Eye> eyes;

  std::string morphs;  // morph targets of the model, a float EXR; empty for none

  // A morph target under the name and with the weight that it has where no motion of the face is
  // given.
  struct Expression {
    std::string name;     // unique, not empty
    std::string target;   // in `morphs`; empty: the one called as the expression
    float weight = 0.0f;  // +-kMostWeight
  };
  std::vector<Expression> expressions;  // none: all targets, at rest

  std::string role_map;  // what joints are in a body (formats/role_map); empty: found by names
};

// Whether what the comments above promise holds, as far as it can be told without the files. Code
// character-value.
Status check(const Character& character);

}  // namespace krok
