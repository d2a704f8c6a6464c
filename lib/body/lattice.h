#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "body/implicit.h"

namespace krok::body {

// Bits per coordinate in a key.
inline constexpr int kLatticeKeyBits = 20;

// A hash key for the coordinates of a lattice point or block, each in [0, 2^20).
constexpr std::uint64_t lattice_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  const auto u = [](std::int64_t v) { return static_cast<std::uint64_t>(v); };
  return (u(x) << (2 * kLatticeKeyBits)) | (u(y) << kLatticeKeyBits) | u(z);
}

// A field with a spatial index: the relevant tubes are stored per block of space.
class BlockedField {
 public:
  // Blocks of kCells^3 lattice cells of size `cell`; only those that may contain the surface.
  static constexpr int kCells = 8;
  BlockedField(const Field& field, double cell, int jobs);

  double value(const Vec3& point) const { return field_.value(point, near(point)); }
  std::vector<TubePoint> places(const Vec3& point) const {
    return field_.places(point, near(point));
  }
  // The nearest of places(); its tube is -1 if there is none.
  TubePoint nearest_place(const Vec3& point) const {
    return field_.nearest_place(point, near(point));
  }
  // Projects a point near the surface onto it, moving it by at most `limit`.
  Vec3 onto_surface(const Vec3& point, double limit) const;

  struct Block {
    std::array<std::int64_t, 3> corner;  // lattice coordinates of its min corner
    Field::Near near;
  };
  // Index of the block with these block coordinates (min corner / kCells), or -1.
  int block_at(std::int64_t x, std::int64_t y, std::int64_t z) const;
  const std::vector<Block>& blocks() const { return blocks_; }
  Vec3 lattice_point(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return origin_ +
           cell_ * Vec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  }
  const Field& field() const { return field_; }
  double cell() const { return cell_; }

 private:
  const Field::Near& near(const Vec3& point) const;

  const Field& field_;
  double cell_;
  Vec3 origin_;
  std::vector<Block> blocks_;
  std::unordered_map<std::uint64_t, std::size_t> index_;
  Field::Near everything_;
};

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
  // Points [first, first + size) of the block with this corner, in octants.
  void sample_part(const std::array<std::int64_t, 3>& corner, const Field::Near& near,
                   const std::array<int, 3>& first, int size, double* values) const;
  // The point offset by -1, 0 or 1 along each axis; block -1 if there is none.
  Point neighbour(Point point, int dx, int dy, int dz) const;

  const BlockedField& field_;
  std::vector<double> values_;                        // [blocks x kPoints]
  std::vector<std::array<std::int32_t, 27>> beside_;  // neighbouring blocks, itself included
};

}  // namespace krok::body
