#pragma once

#include <span>
#include <vector>

#include "camera/framing.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"

// The part of the character to frame.

namespace krok {

enum class Framing : unsigned char {
  full,   // the whole character
  upper,  // from the hips up, including the arms
  head,   // the head, or the neck if the head has no other joint
  joint   // one joint with its neighbours
};

// The character as balls around its joints, sized by its height. Ancestors of the hips that only
// position the character, props and helpers are ignored, unless there are no other joints.
struct ActorShape {
  std::vector<int> shown;     // joints that must be in the image; not empty
  std::vector<int> body;      // all joints the camera stays clear of
  std::vector<double> radii;  // [joints], metres
  std::vector<int> parents;   // [joints], for the bones; -1 for none
};

// `clip` gives the character's height if the reference pose has none; `joint` is that of
// Framing::joint. Codes: camera-empty (no joints or no frames), camera-part (no joint has the roles
// of that part).
Result<ActorShape> actor_shape(const Clip& clip, const RoleMap& roles, Framing framing,
                               int joint = 0);

// The balls of `joints` in one frame.
void balls_of(const ActorShape& shape, std::span<const int> joints,
              std::span<const Vec3f> positions, std::vector<Ball>& balls);

// Distance of a point from the surface of the body: the nearest of all bones, each with the radius
// of the smaller of its end balls. Negative inside.
double distance_to_body(const ActorShape& shape, std::span<const Vec3f> positions,
                        const Vec3& point);

}  // namespace krok
