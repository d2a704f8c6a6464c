#pragma once

#include "samples/generator/actor.h"
#include "scene/clip.h"

// Getting up from lying, to follow a fall.

namespace krok::samples {

enum class Lying : unsigned char {
  front,  // pushes up to hands and knees, half-kneels, stands
  back,   // sits up, squats, stands
  side    // on the left side: rolls to the front, then as from the front
};

struct RiseOptions {
  Lying from = Lying::front;
  double stature = 1.75;  // metres, 0.5 .. 2.5
  double pace = 1;        // 0.25 .. 4: 2 is twice as fast
  double rate = 60;       // frames per second, 1 .. 1000
};

// Starts at rest, and ends at rest where and as a walk of make_walk() from standing begins, facing
// +Z. Knees, hands and feet that carry stay where they are. Code: rise-option.
Result<Clip> make_rise(const RiseOptions& options);

}  // namespace krok::samples
