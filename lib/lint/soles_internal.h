#pragma once

#include <array>
#include <optional>
#include <vector>

#include "contacts/contacts.h"
#include "lint/series_internal.h"

// The points of the soles over the frames: which of them carry the body, and how they slip.

namespace krok::lint {

inline constexpr double kStepEnd = 0.06;  // seconds in which a foot lands or leaves, at least
inline constexpr double kLongestStepEnd = 0.15;  // while it is much faster than at its slowest

struct Soles {
  FoundContacts found;
  std::vector<std::vector<Vec3>> places;      // [tracks][frames], metres
  std::vector<std::vector<Vec3>> velocities;  // [tracks][frames], metres per second
  double floor = INFINITY;                    // height of the lowest contact, metres
  // [frames][FootSide], the slowest point of each foot that is near the ground, -1 for a foot in
  // the air.
  std::vector<std::array<int, 2>> carrying;
  // [frames], that of the slower foot; -1 while it lands or leaves.
  std::vector<int> bearing;
  // [frames][FootSide], metres per second, level: that of the slowest place between the carrying
  // point and the foot's others, about which the foot turns.
  std::vector<std::array<Vec3, 2>> slips;
  // [FootSide][frames], of feet whose points are all estimated, from where their joint turns to:
  // the joint, which rests where the foot does. Otherwise empty.
  std::array<std::vector<Vec3>, 2> ankles, ankle_velocities;

  const SolePoint& point(int track) const {
    return found.tracks[static_cast<std::size_t>(track)].point;
  }
  std::size_t side(int track) const { return static_cast<std::size_t>(point(track).side); }
  const Vec3& slip(int track, int frame) const {
    return slips[static_cast<std::size_t>(frame)][side(track)];
  }
  double speed(int track, int frame) const { return slip(track, frame).norm(); }
};

// Nothing without feet.
std::optional<Soles> soles_of(const Series& series);

// Whether the body stands on a foot; not of who sits, with feet on the floor or above it, crawls or
// lies.
bool stands(const Series& series, const Soles& soles, int track, int frame);

// The shortest of the vectors from `a` to `b`: the movement of the place of a foot about which it
// turns, if its ends move by these. At most `part` of the way to `b`.
Vec3 shortest_between(const Vec3& a, const Vec3& b, double part = 1);

inline Vec3 level(const Vec3& vector) {
  return {vector.x(), 0, vector.z()};
}

void find_slides(const Series& series, const Soles& soles, MotionFaults& out);
void find_ground_faults(const Series& series, const Soles& soles, MotionFaults& out);

}  // namespace krok::lint
