#pragma once

// What people change where the ground rises or falls, by its grade.
//
// Figures are from
// - Franz, Kram, "The effects of grade and speed on leg muscle activations during walking" (Gait &
//   Posture 35, 2012), table 1: stride frequency at 1.25 m/s and -9 to +9 degrees: 0.99, 0.98,
//   0.95, 0.93 (level), 0.91, 0.91, 0.92 Hz. At one speed, strides are as much shorter as they are
//   faster.
// - Reznick, Embry, Neuman, Bolivar-Nieto, Fey, Gregg, "Lower-limb kinematics and kinetics during
//   continuously varying human locomotion" (Scientific Data 8, 2021): the middles of the ranges of
//   its joint angles at 0, 25 and 50 % of the cycle, slopes of 5 and 10 degrees. Knee: level 6, 11,
//   8, up 23, 18, 3, down 3, 20, 23 degrees; hip at the strike: level 34, up 52, down 28. With
//   these, the line from hip to ankle is turned against gravity by half of the grade.
// - Leroux, Fung, Barbeau, "Postural adaptation to walking on inclined surfaces" (Gait & Posture
//   15, 2002): the trunk leans forward uphill, and much less backward downhill.
// - Riener, Rabuffetti, Frigo, "Stair ascent and descent at different inclinations" (Gait & Posture
//   15, 2002): on stairs the forefoot strikes first, up and down, at every inclination.
// - McIntosh, Beatty, Dwan, Vickers, "Gait dynamics on an inclined walkway" (Journal of
//   Biomechanics 39, 2006): ankle dorsiflexion at the strike grows uphill, and stays downhill.
// Of the last three only the directions are taken: how far the trunk leans and the forefoot points
// is chosen here, and the pelvis is lowered so that the knee in mid-stance is Reznick's.

namespace krok::gait {

struct SlopeGait {
  double duration = 1;   // of a step, relative to that on the level
  double length = 1;     // the same of its length
  double ahead = 0;      // of the pelvis on the way, of the leg's length
  double lower = 0;      // of the pelvis, of the leg's length
  double lean = 0;       // of the trunk, radians, forward on the way
  double landing = 1;    // of the pitch, toes up, with which the heel strikes
  double forefoot = 0;   // 0 to 1: the forefoot strikes first
  double toes_down = 0;  // pitch of the foot then, radians
};

// `grade`: radians, of the line from print to print, > 0: up. `sole`: of the sole on the way: 0 on
// the treads of stairs.
SlopeGait slope_gait(double grade, double sole);

}  // namespace krok::gait
