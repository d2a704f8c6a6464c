#pragma once

#include <span>
#include <vector>

#include "contacts/sole_points.h"
#include "core/result.h"
#include "scene/motion_keys.h"

// Foot contact detection: when and where heels, balls and tips of the feet touch a support.

namespace krok {

// Speeds and heights are for a leg of 0.86 m, hip to ankle (a person of 1.75 m), and are scaled by
// the actual leg length, so that children and captures in the wrong unit are handled. The
// thresholds are the usual ones of foot-skate clean-up (Kovar, Schreiner and Gleicher 2002;
// Ikemoto, Arikan and Forsyth 2006) with hysteresis.
struct ContactOptions {
  double on_speed = 0.15, off_speed = 0.25;    // metres per second
  double on_height = 0.03, off_height = 0.05;  // metres above the support
  double shortest = 0.1;                       // seconds
  // Positions are low-pass filtered forwards and backwards at this frequency before differentiation
  // (Hz; 0: off), so that jitter does not count as movement. If a capture jitters more than this
  // removes, the cutoff is lowered, to at least 5 Hz, and twice the remaining jitter is added to
  // the speeds above in quadrature. If the frame rate is too low for the filter, positions are used
  // unfiltered.
  double cutoff = 15;
  // Moves starts and ends from the threshold crossings of speed and height to the break between
  // moving and staying in the unfiltered positions.
  bool refine = true;
};

// A point of the sole over time.
struct PointTrack {
  SolePoint point;
  std::vector<double> speed;   // metres per second, [frames]
  std::vector<double> height;  // metres above the support, [frames]
};

// A contact interval of one point.
struct Stay {
  int track = 0;                              // index into FoundContacts::tracks
  double start = 0, end = 0;                  // seconds
  bool open_start = false, open_end = false;  // in contact at the clip's first or last frame
  Vec3 place = Vec3::Zero();                  // position of the sole point, metres, world
};

struct FoundContacts {
  double leg_length = 0;           // metres
  std::vector<PointTrack> tracks;  // left foot before right, heel, ball, tip
  std::vector<Stay> stays;         // by track, then start
  // The contacts to be stored in a file: the stays of points that a joint marks, and those of the
  // heel for the ankle joint. By start, then joint.
  std::vector<Contact> contacts;
  Diagnostics warnings;
};

// Finds the contacts of heels, balls and tips of the feet, each separately. A contact starts when a
// point's speed falls below on_speed and its height above the support below on_height, and lasts
// until it exceeds off_speed or off_height, for at least `shortest` (or less if cut off by the
// clip's ends). Gaps of less than half of that in one position are closed.
//
// The support is local: each contact's own level, so that stairs, slopes and floating captures do
// not matter. A still point is in the air if the same part of a foot was lower at the same position
// (within 0.15 m), or if it is higher than the other foot, which is in contact throughout. The
// support height between two contacts is interpolated.
//
// Codes: contacts-feet if the roles include no leg. Warnings: contacts-none (no contact: the
// character floats or walks on a treadmill), contacts-short (fewer than three frames).
Result<FoundContacts> find_contacts(const Clip& clip, const RoleMap& roles,
                                    const ContactOptions& options = {});

// The frame halfway through a contact, of a motion that has frames.
int middle_frame(const Contact& contact, double rate, int frames);

// Sets the places of contacts to where the motion has their joints halfway through: those of a
// motion in place move.
void place_contacts(const Clip& clip, std::span<Contact> contacts);

}  // namespace krok
