#pragma once

#include "samples/generator/actor.h"
#include "scene/clip.h"

// Motions of the figure's upper body, standing where a walk from standing begins: what is laid over
// a walk. The feet and the pelvis do not move.

namespace krok::samples {

enum class Gesture : unsigned char {
  wave,  // an arm is lifted, the forearm waves, the arm comes down again
  limp,  // the trunk leans over one leg while that would stand, once from a strike to the next
  look   // the head turns to a side and back
};

struct GestureOptions {
  Gesture gesture = Gesture::wave;
  Side side = Side::right;  // the arm that waves, the leg that limps, where the head turns
  double stature = 1.75;    // metres, 0.5 .. 2.5
  double duration = 3;      // seconds, 0.2 .. 600; of a limp: a stride
  double rate = 60;         // frames a second, 1 .. 1000
};

// Begins and ends with the same pose, at rest; a limp also with no lean, at the strike of its leg.
// Code: gesture-option.
Result<Clip> make_gesture(const GestureOptions& options);

}  // namespace krok::samples
