#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/motion_keys.h"

// Which moments of several motions are the same moment of their structure. Generic time counts
// them: 0 at the first, 1 at the second, and so on.

namespace krok::blend {

struct Correspondence {
  std::vector<std::string> names;          // [moments], "left_strike"
  std::vector<std::vector<double>> times;  // [motions x moments], seconds, rising
  Diagnostics notes;                       // what was left out of the motions

  int moments() const { return static_cast<int>(names.size()); }
};

// At least two moments, for each motion as many times, rising by at least a microsecond and
// finite. Code: blend-keys.
Status check(const Correspondence& correspondence);

// Beginnings and ends alone. Durations are in seconds, positive; blend-duration where one is not.
Result<Correspondence> ends_alone(std::span<const double> durations);

struct KeyedMotion {
  std::string name;     // for messages
  double duration = 0;  // seconds
  const MotionKeys* keys = nullptr;
  double shortest = 2e-3;  // seconds between moments: two frames
};

// Moments by the names of the keytimes. Where all motions have the same names in the same order,
// all are taken, with the beginning and the end if all have time before the first keytime and
// behind the last; a motion that has none, `shortest` or less, is taken to begin or end with it.
// Otherwise each motion's names are aligned with the first one's: the stretch with the most in
// common, where at most one in a row is passed over on either side; what lies outside is left out,
// which the notes tell. Moments less than `shortest` after the one before
// in some motion are left out too. Code: blend-keys where a motion has no keytimes or more than
// 5,000, or fewer than two are common to all.
Result<Correspondence> match_keytimes(std::span<const KeyedMotion> motions);

}  // namespace krok::blend
