#pragma once

#include <vector>

// Stances of a foot, and its turning points relative to the pelvis.

namespace krok::contacts {

inline constexpr double kUsualLeg = 0.86;   // metres, hip to ankle
inline constexpr double kUsualCycle = 1.1;  // seconds

struct Stance {
  double start = 0, end = 0;  // seconds
  bool open_start = false, open_end = false;
  bool slides = false;  // found without a contact
};

// Times, in seconds, at which a foot is furthest ahead of and behind the pelvis.
struct Seeds {
  std::vector<double> front, back;
};

// Turning points of a curve (metres, [frames]) that differ by more than `least` from one to the
// next.
Seeds turning_points(const std::vector<double>& curve, double rate, double least);

// Median time from a seed to the next of its kind, seconds, clamped to 0.4 .. 2.5; kUsualCycle if
// there is none.
double cycle_of(const Seeds& seeds);

// Whether the foot swings at a time, so that every event has a seed: the seeds around it are less
// than a cycle apart.
bool is_seeded(const Seeds& seeds, double time, double cycle);

}  // namespace krok::contacts
