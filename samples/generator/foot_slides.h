#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "roles/roles.h"
#include "samples/generator/walk.h"

// Feet that slide while they stand, as badly captured ones do.

namespace krok::samples {

struct LegRoles {
  int upper = -1, lower = -1, foot = -1;
};
// Left, right.
std::array<LegRoles, 2> legs_of(const RoleMap& roles);

// Moves a foot in one frame by two-bone inverse kinematics, its orientation kept; joints below the
// foot go along. False where the leg is too short; then nothing is done, or what it reaches.
bool move_foot(Clip& clip, int frame, const LegRoles& leg, const Vec3& shift,
               bool as_far_as_it_reaches = false);

// A stance of one foot, seconds.
struct Stance {
  std::size_t side = 0;
  double start = 0, end = 0;
};
std::vector<Stance> stances_of(const Walk& walk);

// How far a foot has slid at a time, as a share of the slide of each stance in its own direction:
// slides begin and end at rest, and are taken back in the swing. `directions` is [stances].
Vec3 slide_at(std::span<const Stance> stances, std::span<const Vec3> directions, std::size_t side,
              double time);

// Moves a foot in one frame; by less where the leg is too short.
void move_foot_within_reach(Clip& clip, int frame, const LegRoles& leg, Vec3 shift);

// The walk with feet that slide by `slide` metres over each stance, each in a random direction
// along the ground. Contacts of the walk stay those of feet that do not.
Clip with_slides(const Walk& walk, double slide, std::uint64_t seed);

}  // namespace krok::samples
