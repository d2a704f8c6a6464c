#pragma once

#include <span>
#include <string>
#include <vector>

#include "contacts/contacts.h"
#include "parametric/library.h"
#include "roles/roles.h"
#include "scene/motion_keys.h"

// Steps cut out of walks: each from the strike of one foot to the next strike of the other.

namespace krok::parametric {

// A walk with its keytimes: left_strike, left_off, right_strike, right_off.
struct Walk {
  std::string name;  // for people and for the examples' names
  const Clip* clip = nullptr;
  const MotionKeys* keys = nullptr;
  const FoundContacts* found = nullptr;  // may be null; tells what the soles are
};

struct CutOptions {
  FootSide swing = FootSide::left;  // the foot that steps
  // Whether steps of the other foot are taken too, as seen in a mirror.
  bool mirror = true;
  // Adds the keytime swing_pass: the swing foot passes the stance foot.
  bool pass = false;
  double shortest = 0.2, longest = 2.0;  // seconds from strike to strike
  // A step is an outlier where one of its measures is further from the median of all than this
  // many median deviations (scaled to a normal distribution's standard deviation), and further
  // than 0.1 m, 15 degrees or 0.3 s, if no more than a tenth of all are. 0: none is.
  double outlier = 5;
};

// A step that was found and not taken.
struct DroppedStep {
  std::string walk;
  double start = 0, end = 0;  // seconds in the walk
  std::string reason;         // for people: "no left_off between the strikes"
};

struct StepLibrary {
  Library library;
  std::vector<DroppedStep> dropped;
};

// The library of all steps. Its skeleton and rate are the first walk's, its keytimes
// stance_strike, swing_off, swing_strike. `parameters` are names as parse_parameter() takes them.
//
// Dropped are steps without the swing foot's off (or with several) between the strikes, too short
// or too long ones, those in which the pose jumps (a joint turns by more than 60 degrees, or the
// root moves by more than 0.3 m, from one frame to the next: a rest pose before the capture), those
// of which a parameter cannot be measured, and outliers.
//
// Codes: parametric-skeleton for a walk on another skeleton, with its name; parametric-feet,
// parametric-parameter; parametric-none where no step is left.
Result<StepLibrary> cut_steps(std::span<const Walk> walks, const RoleMap& roles,
                              std::span<const std::string> parameters, const CutOptions& options);

}  // namespace krok::parametric
