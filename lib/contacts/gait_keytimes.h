#pragma once

#include <vector>

#include "contacts/contacts.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// Gait event detection: keytimes of strikes and toe-offs.

namespace krok {

struct GaitOptions {
  // Min travel of a foot relative to the pelvis, forward or back, in a step; in leg lengths.
  double least_reach = 0.12;
  // A foot that leaves the ground and comes down again has made a step if it was lifted or moved by
  // more than this; metres, for a leg of 0.86 m.
  double least_lift = 0.02, least_way = 0.05;
  // A foot rolling over its heel or toes is slower and lower than this; metres per second and
  // metres, for a leg of 0.86 m.
  double touch_speed = 0.6, touch_height = 0.04;
  // A foot without contacts is in stance while slower than this fraction of its max speed.
  double sliding_speed = 0.25;
  // A foot without contacts is down below this height above the lowest point of both feet within a
  // cycle; metres, for a leg of 0.86 m.
  double low_height = 0.08;
  // A foot that drifts while it lands is down when its deceleration has fallen to this part of its
  // peak.
  double landed = 0.3;
  // ... and it is no faster than this: half of the fastest landings, since a stop seen through a
  // low-pass filter has passed half its speed when it happens; metres per second, for a leg of
  // 0.86 m (Winter, "Foot trajectory in human gait", Phys. Ther. 72, 1992: up to 1 m/s).
  double landing_speed = 0.5;
  // Min height of the pelvis above the lower foot, in leg lengths; below it the character sits,
  // lies or crawls.
  double least_height = 0.6;
};

struct Gait {
  // left_strike, left_off, right_strike, right_off: a foot's first and last touch. Ascending, at
  // least 10 microseconds apart.
  std::vector<Keytime> keytimes;
  // The number of keytimes without a contact, estimated from the foot's turning points ahead of or
  // behind the pelvis.
  int from_seeds = 0;
  Diagnostics warnings;
};

// Finds the steps of walking, running, stepping in place or jumping. A foot is in stance while any
// of its points is in contact, extended while it rolls over heel or toes: from when it becomes
// slower than touch_speed before that to when it becomes faster after. A heel (walking backwards:
// ball or tip) that drifts meanwhile, because the true one is elsewhere in the foot, strikes when
// its deceleration has fallen to 0.3 of its peak and it is no faster than feet land. Without
// contacts, a foot is in stance while it is much slower than in swing.
//
// Stances are compared with the seeds, the times at which the foot is furthest ahead of and behind
// the pelvis in the direction of travel (Zeni, Richards and Higginson, "Two simple methods for
// determining gait events", Gait & Posture 27, 2008; below 0.3 m/s in the facing direction). A gap
// in a stance between a front seed and its back seed is ignored. A strike or toe-off without a
// contact, of a foot that is down, is placed after its seed by the usual offset of the others; so
// is one over 0.15 s away from there, unless the foot moves in between, and if the capture jitters
// all are pulled towards it. Seeds whose offsets scatter by over 0.05 s predict no events.
//
// In forward walking on level ground the heel leaves first, and toe-off is when the toes are
// furthest behind the pelvis. This defines toe-off if the foot has no point for the toes, or one
// that leaves over 25 ms earlier in most steps of that foot or of both, and where it leaves over 60
// ms earlier: the toes of many captures do not bend. In runs (the
// pelvis is lowest over the standing foot, or the Froude number exceeds 0.5), on stairs and in
// backward steps feet leave otherwise, and only contacts define toe-off.
//
// A clip cut at a strike has that strike at its start or end. Nothing is found while the pelvis is
// low: sitting, lying, crawling.
//
// Below 100 frames per second (45 if it jitters much) events are found between frames, on a clip
// interpolated to a multiple of its rate, so that a capture has the same events at any rate. In
// runs contacts begin late and end early, since feet land and leave fast: the events are where the
// slowest point of the foot passes 0.12 of its max speed; offs of backward walks, 0.06. Where an
// event between two strikes or two toe-offs a cycle apart is missing, it is placed by the usual
// lengths of stance and swing.
//
// Warnings: gait-none (no step), gait-implausible (see check_gait()), gait-seeds (strikes or
// toe-offs without a contact; a note if there are at most two, and an eighth of all), gait-in-place
// (steps without any contact: the character walks on a moving ground).
Gait find_gait(const Clip& clip, const RoleMap& roles, const FoundContacts& found,
               const GaitOptions& options = {});

}  // namespace krok
