#pragma once

#include "samples/generator/actor.h"
#include "scene/clip.h"

// Upper-body motions to layer on a walk, standing where a walk from standing begins. Feet and
// pelvis do not move.

namespace krok::samples {

enum class Gesture : unsigned char {
  wave,  // raises an arm, waves the forearm, lowers the arm
  limp,  // leans the trunk over one leg during its stance, for one stride
  look   // the head turns to a side and back
};

struct GestureOptions {
  Gesture gesture = Gesture::wave;
  Side side = Side::right;  // of the waving arm, the limping leg or the look
  double stature = 1.75;    // metres, 0.5 .. 2.5
  double duration = 3;      // seconds, 0.2 .. 600; one stride for a limp
  double rate = 60;         // frames per second, 1 .. 1000
};

// Starts and ends in the same pose, at rest; a limp starts and ends without lean, at the strike of
// its leg. Code: gesture-option.
Result<Clip> make_gesture(const GestureOptions& options);

}  // namespace krok::samples
