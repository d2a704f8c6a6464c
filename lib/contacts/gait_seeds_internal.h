#pragma once

#include <vector>

// The to and fro of a foot, and when it stands.

namespace krok::contacts {

inline constexpr double kUsualLeg = 0.86;   // metres, hip to ankle
inline constexpr double kUsualCycle = 1.1;  // seconds

struct Stance {
  double start = 0, end = 0;  // seconds
  bool open_start = false, open_end = false;
  bool slides = false;  // no contact shows it
};

// Moments, in seconds, at which a foot is furthest before and behind the pelvis.
struct Seeds {
  std::vector<double> front, back;
};

// The turning points of a curve (metres a frame) that differ by `least` from one to the next.
Seeds turning_points(const std::vector<double>& curve, double rate, double least);

// The usual time from a seed to the next of its kind, seconds; kUsualCycle where there are none.
double cycle_of(const Seeds& seeds);

// Whether the foot swings to and fro at a moment, so that every event has a seed: the seeds around
// it are less than a cycle apart.
bool is_seeded(const Seeds& seeds, double time, double cycle);

}  // namespace krok::contacts
