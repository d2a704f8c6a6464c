#pragma once

#include <string>
#include <vector>

#include "scene/camera_track.h"
#include "scene/character.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/model.h"
#include "scene/morph_set.h"
#include "scene/stretch.h"

namespace krok {

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
