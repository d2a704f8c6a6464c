#pragma once

#include <vector>

// Limbs that straighten softly over time where they are too short for their goals.

namespace krok {

// The number of frames in 0.12 s at `rate` fps, at most 256.
int softening_reach(double rate);

// The softness (TwoBoneGoal::softness) with which a limb of this `length` straightens, metres,
// [frames]: 1.5 of what it is too short by, `lacks` (metres, [frames], >= 0), up to 0.06 of its
// length, and as much in the frames before and after. Empty where it is never too short.
std::vector<double> softness_of(std::vector<double> lacks, double length, double rate);

}  // namespace krok
