#pragma once

#include <memory>

#include "scene/character.h"
#include "scene/scene.h"
#include "skin/skin.h"

namespace krok {

struct ActorSceneOptions {
  SkinMethod method = SkinMethod::linear;
  // A mesh for each part of the model, with the vertices that it uses; otherwise one for all.
  bool by_part = false;
};

// An actor as it is shown and compared: its mesh at rest or skinned, an animation with a key at
// each frame for each motion, interpolated in between. Without a motion the reference pose, without
// a mesh the joints alone. Faces are at rest as the model has them.
Scene scene_of(std::shared_ptr<const Actor> actor, const ActorSceneOptions& options = {});

}  // namespace krok
