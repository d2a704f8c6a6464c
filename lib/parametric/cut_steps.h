#pragma once

#include <span>
#include <string>
#include <vector>

#include "contacts/contacts.h"
#include "parametric/library.h"
#include "roles/roles.h"
#include "scene/motion_keys.h"

// Cuts walks into steps, each from the heel strike of one foot to the next strike of the other, and
// into what is at their ends: first steps out of standing, last steps into it, and standing.

namespace krok::parametric {

// A walk with its keytimes: left_strike, left_off, right_strike, right_off.
struct Walk {
  std::string name;  // for messages and the examples' names
  const Clip* clip = nullptr;
  const MotionKeys* keys = nullptr;
  const FoundContacts* found = nullptr;  // may be null; used to find the soles
  std::string style{};                   // of its examples
};

// What is cut: steps of walks have the keytimes stance_strike, swing_off, swing_strike. In a run
// the stance foot leaves the ground before the swing foot strikes: stance_strike, stance_off,
// swing_strike. A first step begins where the actor begins to move: stand, swing_off, swing_strike;
// a last one ends where he has come to rest: stance_strike, swing_off, swing_strike, stand. An
// actor stands while his hips go over the ground at less than 6 cm/s and no foot is lifted:
// stand, stand_end.
//
// Walks and runs go forward, or step on the spot. Steps backward, to the side and turns on the spot
// are gaits of their own, with the keytimes of walks; blended with others, steps would be none of
// them. To the side and in turns one foot leads and the other closes up: `side` and `turn` are the
// steps of the foot that leads.
enum class StepGait : unsigned char {
  walk,
  run,
  start,
  stop,
  stand,
  backward,
  side,
  side_closing,
  turn,
  turn_closing
};

// The names of a step's keytimes, without swing_pass.
std::vector<std::string> keytimes_of(StepGait gait);

struct CutOptions {
  StepGait gait = StepGait::walk;
  FootSide swing = FootSide::left;  // the stepping foot
  // Whether steps of the other foot are mirrored and used too.
  bool mirror = true;
  // Adds the keytime swing_pass, when the swing foot passes the stance foot. Not when standing.
  bool pass = false;
  double shortest = 0.2,
         longest = 2.0;  // seconds from strike to strike
  // A step is an outlier if one of its measures differs from the median by more than this many
  // median absolute deviations (scaled to the standard deviation of a normal distribution) and by
  // more than 0.1 m, 15 degrees or 0.3 s, provided that at most a tenth of all steps do. 0 keeps
  // all.
  double outlier = 5;
};

inline constexpr const char* kOfARun = "it is of a run";  // begins such steps' reason

// A step that was found but not used.
struct DroppedStep {
  std::string walk;
  double start = 0, end = 0;  // seconds in the walk
  std::string reason;         // for messages: "no left_off between the strikes"
};

// For messages: "9 it does not go backward, 2 an outlier"; the three commonest reasons, of outliers
// without their numbers.
std::string commonest_reasons(std::span<const DroppedStep> dropped);

struct StepLibrary {
  Library library;
  std::vector<DroppedStep> dropped;
};

// Builds the library of all steps. Skeleton and rate are those of the first walk, keytimes are
// those of the gait. `parameters` are names for parse_parameter().
//
// Drops steps of another direction than the gait's; steps with no or several offs of that foot
// between the strikes; steps that are too short or too long; steps with a jump in the pose (a joint
// rotates by more than 60 degrees or the root moves by more than 0.3 m between frames, as after a
// rest pose before the capture); steps with a parameter that cannot be measured; and outliers.
//
// Codes: parametric-skeleton for a walk on another skeleton, with its name; parametric-feet,
// parametric-parameter; parametric-none if no step is left.
Result<StepLibrary> cut_steps(std::span<const Walk> walks, const RoleMap& roles,
                              std::span<const std::string> parameters, const CutOptions& options);

}  // namespace krok::parametric
