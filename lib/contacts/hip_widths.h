#pragma once

// The widths of two actors' hips.

namespace krok {

// Metres by which each foot of an actor is to be farther to its side than that of the actor it
// follows, so that it is as far from its hip: half of what the hips are wider, negative for
// narrower ones. 0 where they differ as those of people do, and as rigs place hip joints: by less
// than 0.06 of the leg on each side; all of it from 0.12. Widths are from hip joint to hip joint,
// `leg` is that of the actor, `other_width` that of the other, in the same scale; metres.
double beside_for_hips(double width, double other_width, double leg);

}  // namespace krok
