#pragma once

#include "core/result.h"
#include "scene/clip.h"

namespace krok {

// As retime() of lib/motion (`keep_last`: LastFrame::kept), but between the frames positions
// relative to the parent follow Hermite cubics and rotations squad curves, with velocities for
// `tension` (tension_velocities(), 0 to 1): smooth where retime() bends at each frame, as of
// motions with few frames. Values at the frames themselves are those of retime() within the
// rounding of floats. Codes: motion-speed unless the speed is positive and finite and the tension
// from 0 to 1; clip-rate, clip-too-long as frames_within().
Result<Clip> retime_on_curves(const Clip& clip, double rate, double speed, double tension,
                              bool keep_last);

}  // namespace krok
