#pragma once

#include <optional>
#include <vector>

#include "contacts/contacts.h"
#include "contacts/gait_keytimes.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// Steps of loops. A loop ends with its first pose, so that its steps are those of a circle: the
// loop is played several times, and the steps of a round in the middle are its own.

namespace krok {

// What maps the first frame of a loop to the last (world to world; a translation and a turn about
// the vertical): the last pose is the first one, up to 0.012 of the reference pose's extent and
// 0.05 of how far joints move. Empty if it is not, for clips of over 20 s or fewer than eight
// frames. `carrier` is what carrying_joint() gives.
std::optional<Transform> loop_displacement(const Clip& clip, int carrier);

// Whether a loop's displacement is none: by less than 0.02 of the reference pose's extent, and 5
// degrees.
bool is_in_place(const Transform& displacement, const Skeleton& skeleton);

// The velocity at which a loop in place travels: the feet on the ground move backwards at it. It
// is the velocity that most of the low points of the soles share, each foot while the other one
// swings. Zero where the feet stay or do something else than walking, and while the pelvis is low:
// sitting, lying, crawling.
Vec3 velocity_of_feet(const Clip& loop, const RoleMap& roles);

// A motion in place as it travels: at the root motion that was taken out of it (travelling() in
// motion/travel.h), or else, of a loop in place, at velocity_of_feet(). Empty for other motions.
std::optional<Clip> travelling_on_feet(const Clip& clip, const RoleMap& roles);

// A loop played three times, as travelling_on_feet().
struct Rounds {
  Clip clip;
  int period = 0;          // frames
  Transform displacement;  // of each round, world to world
};
// Empty if the clip is no loop.
std::optional<Rounds> rounds_of(const Clip& clip, const RoleMap& roles);

// Keytimes of a loop in each of three rounds. Those at both ends are one.
std::vector<Keytime> in_rounds(const std::vector<Keytime>& keytimes, const Rounds& rounds);

struct FoundSteps {
  FoundContacts contacts;
  Gait gait;
};
// find_contacts() and find_gait() of a motion as it travels, and of a loop that is in place, or in
// which no foot strikes twice, on its circle: contacts
// across the seam are two, and a keytime at the seam is at both ends. Contacts of a motion in place
// are placed by place_contacts(). Where feet of a loop in place slide so much that events are
// missing, they are when velocity_of_feet() has a foot on the ground, with warning gait-in-place.
// Codes: those of find_contacts().
Result<FoundSteps> find_steps(const Clip& clip, const RoleMap& roles);

}  // namespace krok
