#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "nodes/scene.h"
#include "render/actor.h"
#include "skin/skin.h"
#include "tools/cli/tool.h"
#include "tools/shared/image.h"
#include "tools/shared/shared_options.h"

// Reads input files as actors that can be rendered.

namespace krok::cli {

struct MovingActor {
  std::string path, name;  // the name is for display
  std::string facts;       // "31 joints, 264 frames", for display
  int frame_count = 0;     // 0 without frames: a model, a scene with keyframes
  double rate = 0;         // frames per second, if it has frames
  double duration = 0;     // seconds; 0 if static
  bool has_body = false;   // drawn as a surface, not as bones
  int joint_count = 0;     // of its skeleton; 0 for a scene that is no body

  // The actor at a time; with frames, at the nearest frame. Thread-safe.
  std::function<render::Actor(double time)> at;
  // World position of the hips, or of whatever node carries the actor, in metres.
  std::function<Vec3(double time)> carrier;
  // Heading: radians about +Y; 0 is +Z, pi/2 is +X.
  std::function<double(double time)> heading;
};

// How actors are read.
struct ActorOptions {
  BodyChoice body = BodyChoice::automatic;
  SkinMethod method = SkinMethod::linear;  // of motions; glTF files are skinned as in viewers
  std::string
      clip;  // of glTF files with animations: a name or an index; empty: see best_animation()
  bool every_clip = false;      // without `clip`: an actor for each animation of a glTF file
  bool first_is_model = false;  // of a glTF or other scene, too, for the motions after it
  // If set, an actor needs to be shown between these times alone: of a long take, no other frames
  // are held in memory.
  std::optional<ClipTime> from = {}, to = {};
};

// The part of an actor's motion between the times of --from and --to, or its ends. Code usage.
Result<ImageSpan> span_of(const MovingActor& actor, const std::optional<ClipTime>& from,
                          const std::optional<ClipTime>& to);

// Reads motions (captures, .anim), models and characters (.model, .character; animated by the
// motions of their skeleton or static, faces at rest) and glTF files, in the order of `paths`. With
// BodyChoice::none, motions, models and glTF files with joints are drawn as bones. glTF files are
// drawn with their materials, see look_of(), and vertex colours, but in the default body colour if
// all are one grey without an image. BodyChoice::automatic is low for more than two motions without
// a body, otherwise medium; motions with the same skeleton and reference pose share one. Codes
// figure-input for a file without an actor, clip-name.
Result<std::vector<MovingActor>> read_actors(const std::vector<std::string>& paths,
                                             const ActorOptions& options, ToolContext& context);

}  // namespace krok::cli
