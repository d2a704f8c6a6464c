#pragma once

#include <array>
#include <vector>

#include "samples/generator/foot_plan.h"
#include "scene/clip.h"

// A generated walk with its ground truth.

namespace krok::samples {

// A ground contact of one contact point, which does not move from `from` to `to`. Seconds from the
// clip's start; clamped to the clip if it extends beyond (`open_start`, `open_end`).
struct Contact {
  int print = 0;  // index into Walk::prints
  double from = 0, to = 0;
  bool open_start = false, open_end = false;
  Vec3 place = Vec3::Zero();  // metres, on the ground
};

struct FootContacts {
  std::vector<Contact> heel;          // the heel contact point
  std::vector<Contact> toe;           // the contact point below the tip of the toes
  std::vector<double> strikes, offs;  // keytimes within the clip: first and last contact
};

struct Walk {
  Clip clip;
  Actor actor;
  WalkOptions options;
  double step_time = 0;
  std::vector<Footprint> prints;     // all that overlap the clip; times from the clip's start
  std::array<FootContacts, 2> feet;  // [Side]
};

// Codes: those of check(WalkOptions), and walk-too-long for more than a million frames.
Result<Walk> make_walk(const WalkOptions& options);

// An actor in the pose with which a walk from standing begins.
struct StandingActor {
  Actor actor;
  std::vector<Transform> pose;  // joint_to_world
};

// Fails as make_walk() for a stature out of its range.
Result<StandingActor> make_standing_actor(double stature);

}  // namespace krok::samples
