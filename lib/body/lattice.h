#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "body/blocked_field.h"

namespace krok::body {

// The values of a field at its lattice points, by block; far outside where there is no block. Away
// from the surface only the sign of a value is meaningful.
class Lattice {
 public:
  static constexpr int kCells = BlockedField::kCells;

  Lattice(const BlockedField& field, int jobs);

  // Values at the corners of a block's cubes: [z][y][x], kCells + 1 each.
  static constexpr int kSide = kCells + 1;
  using Cubes = std::array<double, static_cast<std::size_t>(kSide* kSide* kSide)>;
  // False if no surface passes through them.
  bool cubes(std::size_t block, Cubes& values) const;

  // Removes inside points until the inside is a topological ball: one component without handles or
  // cavities. Regrows it from its deepest point by adding simple points only, deepest first, so
  // that handles are cut where they are thinnest. A point of Kuhn's subdivision is simple (adding
  // it keeps the topology) if those of its 14 neighbours that are inside are connected, and so are
  // those outside (after Bertrand 1994, for cubic grids).
  void make_ball();

  const BlockedField& field() const { return field_; }

 private:
  struct Point {
    std::int32_t block;
    std::uint16_t at;  // index in the block: x + 8 y + 64 z
  };
  static constexpr std::size_t kPoints = static_cast<std::size_t>(kCells * kCells * kCells);
  void sample(std::size_t block);
  // The point offset by -1, 0 or 1 along each axis; block -1 if there is none.
  Point neighbour(Point point, int dx, int dy, int dz) const;

  const BlockedField& field_;
  std::vector<double> values_;                        // [blocks x kPoints]
  std::vector<std::array<std::int32_t, 27>> beside_;  // neighbouring blocks, itself included
};

}  // namespace krok::body
