#pragma once

#include <span>
#include <vector>

#include "terrain/terrain.h"

namespace krok::settling {

// The ground as a ball (a paraboloid) of 1.5 m radius rolls over it: what lies across stairs rests
// on a ramp over the edges of the steps (morphological closing). Nowhere below the ground.
class RolledGround final : public Terrain {
 public:
  // Over a rectangle on the ground (x, z); beyond it the ground is as it is. `ground` must outlive
  // this.
  RolledGround(const Terrain& ground, const Vec2& low, const Vec2& high, int jobs = 0);

  // Whether there are steps: heights that differ by more than 1.25 of the way from one place to the
  // next (51 degrees).
  bool has_steps() const { return has_steps_; }

  std::optional<GroundPoint> at(double x, double z, double below) const override;

 private:
  void find_heights(const Vec2& extent, double size);
  void spread(std::span<const float> below, float sign);
  float cell(int column, int row) const {
    return heights_[static_cast<std::size_t>(row * columns_ + column)];
  }
  double height(double column, double row) const;  // NaN where there is none

  const Terrain& ground_;
  int jobs_;
  Vec2 low_;
  double size_ = 0;  // of a cell, metres
  int columns_ = 0, rows_ = 0;
  std::vector<float> heights_;  // [rows x columns], NaN where there is no ground
  bool has_steps_ = false;
};

}  // namespace krok::settling
