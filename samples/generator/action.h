#pragma once

#include <optional>

#include "samples/generator/actor.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// Actions in place, with a point that hand or foot come to: reaching for something, kicking a ball.
// They start and end where and as a walk of make_walk() from standing begins.

namespace krok::samples {

enum class ActionKind : unsigned char {
  reach,  // a hand goes to a point, stays for a moment and comes back; keytimes begin, touch, end
  kick    // a foot swings back, strikes and follows through; keytimes begin, back, strike, end
};

struct ActionOptions {
  ActionKind kind = ActionKind::reach;
  Side side = Side::right;  // of the hand or the foot
  // Of wrist or ankle at the touch or strike: to the actor's side `side`, up, ahead; metres for an
  // actor of 1.75 m, from the heel of the other foot. Default: in the middle of what is in reach.
  std::optional<Vec3> target;
  double stature = 1.75;  // metres, 0.5 .. 2.5
  double pace = 1;        // 0.25 .. 4: 2 is twice as fast
  double rate = 60;       // frames per second, 1 .. 1000
};

struct Action {
  Clip clip;
  MotionKeys keys;    // contacts of ankles and toes that stand
  double missed = 0;  // metres by which the target is out of reach
};

// Joints turn from the stance to the pose at the touch and back along quintics in time (the
// smoothest way from rest to rest, Flash and Hogan 1985). Feet that stand stay where they are.
// Code: action-option.
Result<Action> make_action(const ActionOptions& options);

}  // namespace krok::samples
