#pragma once

#include <array>
#include <cstddef>

// Shared by pack_orientation and its SIMD version. Constants only: of an inline function compiled
// for several instruction sets, the linker might keep a version that the CPU cannot run.

namespace krok::orientation_search {

// Steps (in units in the last place) by which the two largest components are moved, nearest first;
// the third is solved for.
inline constexpr int kReach = 6;
inline constexpr int kSide = 2 * kReach + 1;

struct Step {
  int first = 0, second = 0;
};

inline constexpr std::size_t kStepCount = std::size_t{kSide} * kSide;
inline constexpr std::array<Step, kStepCount> kSteps = [] {
  std::array<Step, kStepCount> steps{};
  std::size_t count = 0;
  for (int ring = 0; ring <= kReach; ++ring) {
    for (int i = -ring; i <= ring; ++i) {
      for (int j = -ring; j <= ring; ++j) {
        if (i == ring || i == -ring || j == ring || j == -ring) steps[count++] = {i, j};
      }
    }
  }
  return steps;
}();

// Threshold to stop searching: 6e-7 rad, a few times the rounding error of four components, and 0.6
// micrometres at a metre. Squared distance of quaternions; the angle is twice the distance.
inline constexpr double kGoodEnough = 3e-7 * 3e-7;

// |w| above which one ring of steps is tried, or three; below, all.
inline constexpr double kOneRing = 0.02;
inline constexpr double kThreeRings = 1e-4;

}  // namespace krok::orientation_search

namespace krok::pack_transforms_detail {

// Scalar reference for the SIMD version of write_transforms with encoding xyz: write_transform for
// each of `count` positions (3 floats each) and orientations (x, y, z, w).
void pack_scalar(const float* positions, const float* orientations, std::size_t count,
                 std::byte* out);

}  // namespace krok::pack_transforms_detail
