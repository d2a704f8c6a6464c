#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "scene/motion_keys.h"

// Time correspondence between several motions: shared moments such as gait events. Generic time
// numbers them: 0 at the first, 1 at the second, and so on.

namespace krok::blend {

struct Correspondence {
  std::vector<std::string> names;          // [moments], "left_strike"
  std::vector<std::vector<double>> times;  // [motions x moments], seconds, increasing
  Diagnostics notes;                       // which parts of the motions were left out

  int moments() const { return static_cast<int>(names.size()); }
};

// Requires at least two moments, and for each motion one finite time per moment, each at least a
// microsecond after the previous one. Code: blend-keys.
Status check(const Correspondence& correspondence);

// Start and end only. Durations in seconds; code blend-duration for one that is not positive.
Result<Correspondence> ends_alone(std::span<const double> durations);

struct KeyedMotion {
  std::string name;     // for messages
  double duration = 0;  // seconds
  const MotionKeys* keys = nullptr;
  double shortest = 2e-3;  // min seconds between moments: two frames
};

// Matches keytimes by name. If all motions have the same names in the same order, all keytimes are
// used, plus "begin" and "end" if every motion has more than `shortest` before its first and after
// its last keytime; if not, a keytime within `shortest` of a motion's start or end is moved there.
// Otherwise each motion's names are aligned with those of the first motion: the range with the most
// matches, skipping at most one keytime in a row on either side; the rest is left out and reported
// in the notes. Moments less than `shortest` after the previous one in any motion are left out too.
// Code: blend-keys if a motion has no keytimes or more than 5,000, or if fewer than two are common
// to all.
Result<Correspondence> match_keytimes(std::span<const KeyedMotion> motions);

}  // namespace krok::blend
