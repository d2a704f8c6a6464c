#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "body/blocked_field.h"

namespace krok::body {

// The values of a field at the points of its lattice, block by block; far outside where there is no
// block. Where the surface cannot be near, a value tells its sign alone.
class Lattice {
 public:
  static constexpr int kCells = BlockedField::kCells;

  Lattice(const BlockedField& field, int jobs);

  // Values of the cubes of a block, corners included: [z][y][x], kCells + 1 each.
  static constexpr int kSide = kCells + 1;
  using Cubes = std::array<double, static_cast<std::size_t>(kSide* kSide* kSide)>;
  // False if no surface passes through them.
  bool cubes(std::size_t block, Cubes& values) const;

  // Takes points away from the inside until it is one ball: one piece without handles and cavities.
  // Grows it anew from its deepest point by simple points alone, the deepest first, so that what
  // handles there are part where they are thinnest. A point of Kuhn's subdivision is simple, and
  // adding it leaves the topology as it is, if those of its 14 neighbours that are inside hang
  // together, and those outside do (Bertrand 1994 gives the idea for cubic grids).
  void make_ball();

  const BlockedField& field() const { return field_; }

 private:
  struct Point {
    std::int32_t block;
    std::uint16_t at;  // in the block: x + 8 y + 64 z
  };
  static constexpr std::size_t kPoints = static_cast<std::size_t>(kCells * kCells * kCells);
  void sample(std::size_t block);
  // The point at an offset of -1, 0 or 1 along each axis; block -1 if there is none.
  Point neighbour(Point point, int dx, int dy, int dz) const;

  const BlockedField& field_;
  std::vector<double> values_;                        // [blocks x kPoints]
  std::vector<std::array<std::int32_t, 27>> beside_;  // blocks around each, itself included
};

}  // namespace krok::body
