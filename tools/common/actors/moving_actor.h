#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/scene.h"
#include "render/actor.h"
#include "skin/skin.h"
#include "tools/common/body_choice.h"
#include "tools/common/tool.h"

// What input files hold as figures that pictures can be made of.

namespace krok {

struct MovingActor {
  std::string path, name;  // the name is for people
  std::string facts;       // "31 joints, 264 frames", for people
  int frame_count = 0;     // 0 where it has no frames: a model, a scene with keys
  double rate = 0;         // frames a second, where it has frames
  double duration = 0;     // seconds; 0 for what does not move
  bool has_body = false;   // drawn with a surface, not as bones

  // The figure at a time; with frames at the frame nearest to it. May be called by several threads.
  std::function<render::Actor(double time)> at;
  // Where its hips are then, or what else carries it; world, metres.
  std::function<Vec3(double time)> carrier;
  // Where it faces then: radians about +Y, 0 is +Z, a quarter turn +X.
  std::function<double(double time)> heading;
};

// Motions (captures, .anim), models and characters (.model, .character, moved by the motions of
// their skeleton or standing alone, faces as they are at rest) and glTF files, in the order of
// `paths`. With BodyChoice::none motions are drawn as bones, and so are models and glTF files that
// have joints; glTF files show their materials where one of them has a picture, see look_of(),
// otherwise they have the colour of bodies; automatic is low for more than two motions that come
// without a body, otherwise medium. `method` is how motions move their bodies; glTF files are
// skinned as viewers do it. Code figure-input for a file that shows no figure.
Result<std::vector<MovingActor>> read_metrics(const std::vector<std::string>& paths,
                                              BodyChoice body, SkinMethod method,
                                              ToolContext& context);

}  // namespace krok
