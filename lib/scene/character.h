#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "scene/camera_track.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "scene/stretch.h"

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

  // How far an eye turns from straight ahead, degrees, 0 to 90. By default the means of 261 adults
  // and children: Lee et al., Differences in eye movement range based on age and gaze direction
  // (Eye 33, 2019).
  struct EyeRange {
    float in = 44.9f, out = 44.2f;  // towards the nose, and away from it
    float up = 27.9f, down = 47.1f;
    friend bool operator==(const EyeRange&, const EyeRange&) = default;
  };

  // An eye position that moves with a joint.
  struct Eye {
    std::string name;                // "left"; unique, not empty
    std::string joint;               // of the model
    Vec3f position = Vec3f::Zero();  // metres, in the model's reference pose; +-kFurthest
    EyeRange range = {};
  };
  std::vector<Eye> eyes;

  // A place at a joint for things that it holds: socket_to_joint.
  struct Socket {
    std::string name;                     // "right_grip"; unique, not empty
    std::string joint;                    // of the model
    Vec3f offset = Vec3f::Zero();         // metres, in the joint's frame; +-kFurthest
    Quat orientation = Quat::Identity();  // in the joint's frame; unit
  };
  std::vector<Socket> sockets;

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

// The node or joint of an eye that has no joint of its own: "left_eye".
std::string eye_joint_name(const Character::Eye& eye);

// Checks everything documented above that can be checked without reading the files. Code
// character-value.
Status check(const Character& character);

// What files hold of a character and operations change: its skeleton and mesh, how it looks, and
// how it moves. Each part may be missing. scene_of() of lib/skin makes a Scene of it to show and
// compare.
struct Actor {
  Model model;                       // without vertices the skeleton alone
  std::vector<Material> materials;   // of the model's parts, with their images
  std::vector<Character::Eye> eyes;  // at joints of the model
  std::vector<Character::Socket> sockets;
  MorphSet morphs;                  // of the model's vertices
  std::vector<float> rest_weights;  // [targets] where no motion of the face is given

  struct Motion {
    std::string name;      // of the file or the animation; may be empty
    Clip clip;             // of the model's skeleton
    Stretches stretches;   // of its joints; none if they are rigid
    MorphWeights weights;  // of its face, at the frames of `clip`; none if it is still
  };
  std::vector<Motion> motions;

  struct Camera {
    std::string name;
    CameraTrack track;
  };
  std::vector<Camera> cameras;

  const Skeleton& skeleton() const { return model.skeleton; }
  bool has_mesh() const { return !model.triangles.empty(); }
};

}  // namespace krok
