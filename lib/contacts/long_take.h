#pragma once

#include "contacts/step_measures.h"
#include "core/progress.h"
#include "core/result.h"
#include "roles/roles.h"
#include "scene/frame_source.h"
#include "scene/motion_keys.h"

// Contacts and steps of takes that do not fit in memory.

namespace krok {

struct LongTakeOptions {
  int part = 1 << 14;           // frames; memory is in proportion to it
  double margin = 10.0;         // seconds before and after a part that are looked at with it
  bool contacts_alone = false;  // no keytimes and measures
};

struct LongTake {
  MotionKeys keys;
  StepMeasures steps;      // of the parts' medians the mean, weighted by their steps
  double slide_speed = 0;  // metres per second, over all parts
  Diagnostics warnings;    // the first of each code, and its part
};

// What find_contacts(), find_gait(), step_measures() and slide_speed() find in parts of a take. An
// event belongs to the part that it is in, a contact that goes on into the next part is one. The
// level of jitter, and what is lower ground, are judged within a part and its margins: a take of
// one part has the same results as those functions (measures up to rounding), a longer one those of
// its minutes rather than of the whole. Steps across the border of two parts do not count for
// StepMeasures.
//
// `jobs` threads, at most four, as in parallel_for; the result does not depend on them.
//
// Codes: contacts-feet, and those of the source.
Result<LongTake> find_in_long_take(const FrameSource& source, const RoleMap& roles, int jobs,
                                   Progress* progress, const LongTakeOptions& options = {});

}  // namespace krok
