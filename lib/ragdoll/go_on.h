#pragma once

#include "core/result.h"
#include "scene/clip.h"

namespace krok::ragdoll {

// Lets a motion go on after its simulated part: the result is `simulated` to its last frame, then
// the frames of `motion` that follow it, to its end. What differs at the last frame decays within
// `span` seconds along quintics that begin with its speed and acceleration (Bollo,
// "Inertialization", 2018; timeline::Decay), each joint relative to its parent, so that neither
// jumps. Both clips have the same skeleton and rate, frame by frame. A motion without further
// frames leaves the clip as it is. Code ragdoll-value if the skeletons or rates differ.
Result<Clip> go_on(const Clip& simulated, const Clip& motion, double span);

}  // namespace krok::ragdoll
