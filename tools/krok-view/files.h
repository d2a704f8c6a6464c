#pragma once

#include <deque>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "draw/viewer_page.h"
#include "scene/character.h"
#include "tools/cli/tool.h"
#include "tools/krok-view/options.h"

namespace krok::cli::view {

// The contents of the input files, which must outlive the page made from them.
struct Files {
  struct Motion {
    std::string path, name;
    Clip clip;
    const Model* body = nullptr;  // points into `models` or `bodies`
    std::span<const Material> materials;
    MotionKeys keys;
    std::vector<draw::ViewedGoal> goals;
  };
  struct Glb {
    std::string path, name;
    std::vector<std::byte> bytes;
    std::vector<std::string> animations;  // their names, which may be empty
    std::vector<double> rates;            // frames per second of each, by its keys
    int animation = 0;                    // that plays first
  };
  struct Camera {
    std::string name;
    CameraTrack track;
  };
  struct Character {
    std::string path, name;
    Actor actor;
    bool used = false;
  };
  std::deque<Motion> motions;
  std::deque<Character> models;
  std::deque<Model> bodies;
  std::deque<Glb> glbs;
  std::deque<Camera> cameras;
};

// Reads all inputs, assigns models and characters to the motions of their skeletons, and builds
// bodies for motions without one. A model without a motion is shown in its reference pose. Faces
// have their character's default expression.
Result<Files> read_files(const Options& options, ToolContext& context);

}  // namespace krok::cli::view
