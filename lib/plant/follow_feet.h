#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "contacts/sole_points.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// Puts the feet of a retargeted actor on the ground of the source motion.

namespace krok {

// The ground under feet. Both functions take a point (metres, world) and refer to the surface below
// it or just above it.
struct GroundBelow {
  std::function<std::optional<double>(const Vec3&)> height;  // metres; empty where there is none
  UpOfGround up;
};

struct FollowedFeet {
  Clip clip;
  std::vector<Contact> contacts;  // of the result's joints, in the times of the source's
  // Largest over all contacts, metres: how far a heel or a ball moves while it stands, and how far
  // it is below or above the ground while the foot is flat; an end that stands out over an edge
  // does not count.
  double drift = 0, off_ground = 0;
  double sunk = 0;         // metres, the deepest that a heel or ball is in the ground at any time
  double source_sunk = 0;  // the same of the source
  double pelvis_lowered = 0;  // metres, the most in any frame
  int out_of_reach = 0;       // frames in which a leg is too short for its place
};

// Lets the feet of `clip` follow those of `source`, of which it is the retargeted copy, scaled by
// `scale`: the same frames at the same rate. Afterwards the actor walks where the source does, at
// the source's scale.
//
// - The body is moved so that the hips are over the source's, at `scale` of their height over the
//   ground between the feet.
// - Each sole is oriented as the source's sole. In a stance the middles of both lie together, or
//   back or ahead of that where a longer foot would stand against a step or over an edge, and
//   beside it by beside_for_hips() (contacts/legs.h) across the hips. A sole that rolls over
//   its heel or ball rolls about its own.
// - In swing the foot moves from one place to the next as the source's foot does.
// - Legs are solved by solve_two_bone(), the pelvis is lowered, smoothly, where they are too short.
//
// `contacts` tell when the source's feet stand; without them find_contacts() does. Codes:
// follow-frames for clips that differ in length or rate; contacts-feet where one of them has no
// legs and feet that are known; plant-contacts where no foot stands at any frame.
Result<FollowedFeet> follow_feet(const Clip& source, const RoleMap& source_roles, const Clip& clip,
                                 const RoleMap& roles, double scale, const GroundBelow& ground,
                                 std::optional<std::span<const Contact>> contacts = {});

}  // namespace krok
