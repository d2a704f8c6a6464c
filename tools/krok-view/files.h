#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "draw/viewer_page.h"
#include "scene/camera_track.h"
#include "scene/clip.h"
#include "scene/material.h"
#include "scene/model.h"
#include "tools/common/character/character_input.h"
#include "tools/common/tool.h"
#include "tools/krok-view/view.h"

namespace krok::view {

// What the input files hold, kept for as long as the page is made of it.
struct Files {
  struct Motion {
    std::string path, name;
    Clip clip;
    const Model* body = nullptr;  // of `models` or `bodies`
    std::span<const Material> materials;
    MotionKeys keys;
  };
  struct Glb {
    std::string name;
    std::vector<std::byte> bytes;
  };
  struct Camera {
    std::string name;
    CameraTrack track;
  };
  struct Character {
    std::string path, name;
    ShownModel shown;
    bool used = false;
  };
  std::deque<Motion> motions;
  std::deque<Character> models;
  std::deque<Model> bodies;
  std::deque<Glb> glbs;
  std::deque<Camera> cameras;
};

// Reads all inputs, gives each model and character to the motions of its skeleton, and builds
// bodies for motions that have none. A model that no motion moves stands in its reference pose.
// Faces are as their character has them at rest.
Result<Files> read_files(const Options& options, ToolContext& context);

}  // namespace krok::view
