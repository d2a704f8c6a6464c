#pragma once

#include <vector>

#include "contacts/contacts.h"
#include "roles/roles.h"
#include "scene/clip.h"
#include "scene/motion_keys.h"

// The keytimes of a gait.

namespace krok {

struct GaitOptions {
  // How far a foot goes to and fro before and behind the pelvis in a step, of the leg's length.
  double least_reach = 0.12;
  // What makes a step of a foot that leaves the ground and comes down again: metres, for a leg of
  // 0.86 m, it is lifted or carried.
  double least_lift = 0.02, least_way = 0.05;
  // What a foot that rolls over its heel or its toes is slower and lower than, metres a second and
  // metres, for a leg of 0.86 m.
  double touch_speed = 0.6, touch_height = 0.04;
  // A foot that never stays stands where it is slower than this part of its fastest.
  double sliding_speed = 0.25;
  // How far above the lowest that any foot comes within a cycle, metres for a leg of 0.86 m, a foot
  // is down that no contact shows.
  double low_height = 0.08;
  // How high the pelvis is over the lower foot, of the leg's length; lower the figure sits, lies or
  // crawls.
  double least_height = 0.6;
};

struct Gait {
  // left_strike, left_off, right_strike, right_off: a foot's first and last touch. Ascending, at
  // least 10 microseconds apart.
  std::vector<Keytime> keytimes;
  // Those that no contact showed, so that they are where the foot turns before or behind the
  // pelvis.
  int from_seeds = 0;
  Diagnostics warnings;
};

// The steps of walking, running, stepping on the spot or jumping. A foot stands while any of its
// points stays, and a little longer: from when it is slower than touch_speed before that, to when
// it is faster after, for it rolls over its heel and its toes. A heel that drifts meanwhile, for
// the true one is elsewhere in the foot, strikes where what stops it lets go: where its slowing
// falls to half of the most. Where nothing stays, a foot stands where it is much slower than in the
// swing.
//
// Stances are held against the seeds, the moments at which the foot is furthest before and behind
// the pelvis in the direction of travel (Zeni, Richards and Higginson, "Two simple methods for
// determining gait events", Gait & Posture 27, 2008; where the figure travels under 0.3 m/s, in the
// direction it faces). A break between a foot's front and its back seed is none. A strike or an off
// that nothing shows, of a foot that is down, is put after its seed by what the others are; so is
// one that is more than 0.15 s off that, unless the foot moves in between, and where the capture
// jitters all are drawn towards it. Seeds that the contacts scatter about by more than 0.05 s tell
// nothing.
//
// A foot that walks forward on level ground, heel first off, leaves with its toes, when they are
// furthest behind the pelvis. That tells its offs where it has no point for the toes, or one that
// leaves more than 25 ms earlier in most steps: the toes of many captures do not bend. In runs
// (known by a pelvis that is lowest over the standing foot, or by a Froude number over 0.5), on
// stairs and in steps to the back feet leave otherwise, and contacts alone tell when.
//
// A clip that is cut at a strike has that strike at its beginning or end. Nothing is found while
// the pelvis is low: sitting, lying, crawling.
//
// Warnings: gait-none (no step), gait-seeds (strikes or offs that no contact showed), gait-in-place
// (steps without contacts throughout: the figure walks on a moving ground).
Gait find_gait(const Clip& clip, const RoleMap& roles, const FoundContacts& found,
               const GaitOptions& options = {});

}  // namespace krok
