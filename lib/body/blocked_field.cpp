#include "body/blocked_field.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace krok::body {

namespace {}  // namespace

BlockedField::BlockedField(const Field& field, double cell, int jobs) : field_(field), cell_(cell) {
  const Eigen::AlignedBox3d bounds = field.bounds();
  origin_ = bounds.min() - Vec3::Constant(2 * cell);
  const double block = cell * kCells;
  std::vector<std::array<std::int64_t, 3>> corners;
  for (const Field::Ball& ball : field.balls()) {
    std::array<std::int64_t, 3> low, high;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = (ball.center[axis] - origin_[axis]) / block, r = ball.radius / block;
      low[static_cast<std::size_t>(axis)] =
          std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(at - r)));
      high[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(at + r));
    }
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t x = low[0]; x <= high[0]; ++x) corners.push_back({x, y, z});
      }
    }
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());

  std::vector<Block> all(corners.size());
  std::vector<char> active(corners.size(), 0);
  const double half_diagonal = 0.5 * block * std::sqrt(3.0);
  parallel_for(corners.size(), 16, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& c = corners[i];
      all[i].corner = {c[0] * kCells, c[1] * kCells, c[2] * kCells};
      const Vec3 center = lattice_point(all[i].corner[0], all[i].corner[1], all[i].corner[2]) +
                          Vec3::Constant(0.5 * block);
      // With a margin of neighbouring cells: if the surface passes within a cell of a block's
      // points, the block with the other end of the lattice edges exists too.
      all[i].near = field.near(center, half_diagonal + 2 * cell);
      active[i] = all[i].near.ranges.empty() ? 0 : 1;
    }
  });
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!active[i]) continue;
    index_.emplace(lattice_key(corners[i][0], corners[i][1], corners[i][2]), blocks_.size());
    blocks_.push_back(std::move(all[i]));
  }
  everything_ = field.near(bounds.center(), bounds.diagonal().norm());
}

int BlockedField::block_at(std::int64_t x, std::int64_t y, std::int64_t z) const {
  if (x < 0 || y < 0 || z < 0) return -1;
  const auto found = index_.find(lattice_key(x, y, z));
  return found == index_.end() ? -1 : static_cast<int>(found->second);
}

const Field::Near& BlockedField::near(const Vec3& point) const {
  const Vec3 at = (point - origin_) / (cell_ * kCells);
  if ((at.array() >= 0).all()) {
    const auto found = index_.find(lattice_key(static_cast<std::int64_t>(at.x()),
                                               static_cast<std::int64_t>(at.y()),
                                               static_cast<std::int64_t>(at.z())));
    if (found != index_.end()) return blocks_[found->second].near;
  }
  return everything_;
}

Vec3 BlockedField::onto_surface(const Vec3& point, double limit) const {
  Vec3 at = point;
  for (int step = 0; step < 4; ++step) {
    const Field::Near& here = near(at);
    const double distance = field_.value(at, here);
    if (std::abs(distance) < 1e-3 * cell_) break;
    const Vec3 slope = field_.gradient(at, distance, here, 0.1 * cell_);
    const double slope2 = slope.squaredNorm();
    if (slope2 < 1e-4) break;
    Vec3 move = -distance / std::max(slope2, 0.25) * slope;
    const double length = move.norm();
    if (length > limit) move *= limit / length;
    at += move;
  }
  const Vec3 moved = at - point;
  const double length = moved.norm();
  return length > limit ? Vec3(point + moved * (limit / length)) : at;
}

}  // namespace krok::body
