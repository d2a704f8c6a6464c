#pragma once

#include <array>
#include <vector>

#include "samples/generator/foot_plan.h"
#include "scene/clip.h"

// A walk with everything known about it: later work holds what it measures against this.

namespace krok::samples {

// A stay of one contact point on the ground: it does not move from `from` to `to`. Seconds from the
// clip's start; the clip's range, where it began before or lasts beyond (`open_start`, `open_end`).
struct Contact {
  int print = 0;  // index into Walk::prints
  double from = 0, to = 0;
  bool open_start = false, open_end = false;
  Vec3 place = Vec3::Zero();  // metres, on the ground
};

struct FootContacts {
  std::vector<Contact> heel;          // the heel's point of the sole
  std::vector<Contact> toe;           // the point of the sole below the tip of the toes
  std::vector<double> strikes, offs;  // keytimes within the clip: first touch, last touch
};

struct Walk {
  Clip clip;
  Actor actor;
  WalkOptions options;
  double step_time = 0;
  std::vector<Footprint> prints;     // all that touch the clip's range; times from the clip's start
  std::array<FootContacts, 2> feet;  // [Side]
};

// Fails with the codes of check(WalkOptions), and walk-too-long for more than a million frames.
Result<Walk> make_walk(const WalkOptions& options);

}  // namespace krok::samples
