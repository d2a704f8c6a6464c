#pragma once

#include <vector>

#include "contacts/sole_points.h"
#include "core/result.h"
#include "scene/motion_keys.h"

// When and where the parts of the feet stand on something.

namespace krok {

// Speeds and heights are those for a leg of 0.86 m, hip to ankle (a person of 1.75 m); all are
// scaled by the figure's own leg, so that a child, or a capture in the wrong unit, is measured by
// its own size. The thresholds are the usual ones of foot-skate clean-up (Kovar, Schreiner and
// Gleicher 2002; Ikemoto, Arikan and Forsyth 2006) with hysteresis.
struct ContactOptions {
  double on_speed = 0.15, off_speed = 0.25;    // metres a second
  double on_height = 0.03, off_height = 0.05;  // metres above the support
  double shortest = 0.1;                       // seconds
  // Positions are low-passed at this frequency both ways before speeds are taken (Hz; 0: not), so
  // that jitter is no movement. Where a capture jitters more than that takes out it is lowered, to
  // 5 Hz at least, and the speeds above are raised by twice what is left. Where the rate is too low
  // for a filter positions are taken as they are.
  double cutoff = 15;
  // Whether starts and ends, found to be where speed and height cross the thresholds, are then put
  // where the positions as captured show the break between moving and staying.
  bool refine = true;
};

// A point of the sole over time.
struct PointTrack {
  SolePoint point;
  std::vector<double> speed;   // metres a second, [frames]
  std::vector<double> height;  // metres above the support found nearest in time, [frames]
};

// A stay of one point.
struct Stay {
  int track = 0;                              // index into FoundContacts::tracks
  double start = 0, end = 0;                  // seconds
  bool open_start = false, open_end = false;  // it was there at the clip's first or last frame
  Vec3 place = Vec3::Zero();                  // of the sole point, metres, world
};

struct FoundContacts {
  double leg_length = 0;           // metres
  std::vector<PointTrack> tracks;  // left foot before right, heel, ball, tip
  std::vector<Stay> stays;         // by track, then start
  // What of it belongs into a file: the stays of points that a joint marks, and of the heel for the
  // ankle's joint. By start, then joint.
  std::vector<Contact> contacts;
  Diagnostics warnings;
};

// The contacts of heels, balls and tips of the feet, each for itself. A point stays where its speed
// falls below on_speed and its height over the support below on_height, until it exceeds off_speed
// or off_height, for at least `shortest` (or up to the clip's ends, where it may have lasted
// beyond); breaks of less than half of that in one place are none.
//
// The support is local: each stay's own level, so that stairs, slopes and captures that float are
// no matter. A still point is in the air, not on a support, where the same part of a foot stood
// lower in the same place (within 0.15 m), or where it is higher than the other foot, which stands
// all the while. Heights in between are interpolated from one stay to the next.
//
// Codes: contacts-feet where the roles know no leg. Warnings: contacts-none (nothing stays: the
// figure floats, or walks on a treadmill), contacts-short (fewer than three frames).
Result<FoundContacts> find_contacts(const Clip& clip, const RoleMap& roles,
                                    const ContactOptions& options = {});

}  // namespace krok
