#include "settle/rolled_ground_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace krok::settling {

namespace {

constexpr double kBall = 1.5, kReach = 1.2, kJump = 1.25;  // metres; rise over run
constexpr double kCells = 200000;                          // at most, or larger ones

}  // namespace

RolledGround::RolledGround(const Terrain& ground, const Vec2& low, const Vec2& high)
    : ground_(ground), low_(low - Vec2::Constant(2 * kReach)) {
  const Vec2 extent = high - low_ + Vec2::Constant(2 * kReach);
  size_ = std::max(size_, std::sqrt(extent.prod() / kCells));
  columns_ = static_cast<int>(std::ceil(extent.x() / size_)) + 1;
  rows_ = static_cast<int>(std::ceil(extent.y() / size_)) + 1;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  heights_.assign(static_cast<std::size_t>(columns_ * rows_), kNone);
  for (int r = 0; r < rows_; ++r) {
    for (int c = 0; c < columns_; ++c) {
      const auto found = ground.at(low_.x() + c * size_, low_.y() + r * size_);
      if (!found) continue;
      double& own = cell(heights_, c, r);
      own = found->height;
      const auto differs = [&](double other) { return std::abs(other - own) > kJump * size_; };
      has_steps_ |= (c > 0 && differs(cell(heights_, c - 1, r))) ||
                    (r > 0 && differs(cell(heights_, c, r - 1)));
    }
  }
  if (!has_steps_) return;
  // The lowest that the ball's centre can be over each place, and then its underside.
  const int reach = static_cast<int>(kReach / size_);
  const int across = 2 * reach + 1;
  std::vector<double> ball;  // [across x across], its surface below the centre; NaN beyond
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const double square = size_ * size_ * (x * x + y * y);
      ball.push_back(square > kReach * kReach ? kNone : std::sqrt(kBall * kBall - square));
    }
  }
  std::vector<double> centres(heights_.size(), kNone);
  const auto roll = [&](std::vector<double>& from, std::vector<double>& to, double sign) {
    for (int r = 0; r < rows_; ++r) {
      for (int c = 0; c < columns_; ++c) {
        double best = kNone;
        for (int y = std::max(0, r - reach); y <= std::min(rows_ - 1, r + reach); ++y) {
          for (int x = std::max(0, c - reach); x <= std::min(columns_ - 1, c + reach); ++x) {
            const int at_ball = (y - r + reach) * across + x - c + reach;
            const double value = cell(from, x, y) + sign * ball[static_cast<std::size_t>(at_ball)];
            if (!std::isnan(value) && !(sign * best >= sign * value)) best = value;
          }
        }
        cell(to, c, r) = best;
      }
    }
  };
  std::vector<double> rolled(heights_.size(), kNone);
  roll(heights_, centres, 1);
  roll(centres, rolled, -1);
  for (std::size_t i = 0; i < rolled.size(); ++i) {
    if (!std::isnan(heights_[i])) heights_[i] = std::max(heights_[i], rolled[i]);
  }
}

double RolledGround::height(double column, double row) const {
  const int c = static_cast<int>(column), r = static_cast<int>(row);
  const double u = column - c, v = row - r;
  const auto of = [&](int x, int y) {
    return heights_[static_cast<std::size_t>(std::min(y, rows_ - 1) * columns_ +
                                             std::min(x, columns_ - 1))];
  };
  return (1 - v) * ((1 - u) * of(c, r) + u * of(c + 1, r)) +
         v * ((1 - u) * of(c, r + 1) + u * of(c + 1, r + 1));
}

std::optional<GroundPoint> RolledGround::at(double x, double z, double below) const {
  auto found = ground_.at(x, z, below);
  const double column = (x - low_.x()) / size_, row = (z - low_.y()) / size_;
  if (!has_steps_ || !found || !(column >= 1) || !(row >= 1) || column > columns_ - 2 ||
      row > rows_ - 2) {
    return found;
  }
  const double rolled = height(column, row);
  if (!(rolled > found->height)) return found;
  found->height = rolled;
  const Vec3 up((height(column - 1, row) - height(column + 1, row)) / (2 * size_), 1,
                (height(column, row - 1) - height(column, row + 1)) / (2 * size_));
  found->normal = up.allFinite() ? Vec3(up.normalized()) : Vec3(Vec3::UnitY());
  return found;
}

}  // namespace krok::settling
