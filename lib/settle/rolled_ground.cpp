#include "settle/settler_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "core/parallel.h"

namespace krok::settling {

namespace {

constexpr double kBall = 1.5, kReach = 1.2;   // metres
constexpr double kWide = 0.04, kJump = 1.25;  // what counts as a step: metres; rise over run
constexpr double kCells = 1e6;                // at most, or larger ones

}  // namespace

RolledGround::RolledGround(const Terrain& ground, const Vec2& low, const Vec2& high, int jobs)
    : ground_(ground), jobs_(jobs), low_(low - Vec2::Constant(kReach)) {
  const Vec2 extent = high - low_ + Vec2::Constant(kReach);
  const double size = std::sqrt(extent.prod() / kCells);
  find_heights(extent, std::max(kWide, size));
  for (int r = 0; r < rows_; ++r) {
    for (int c = 0; c < columns_; ++c) {
      const auto differs = [&](int column, int row) {
        return std::abs(cell(column, row) - cell(c, r)) > kJump * size_;
      };
      has_steps_ |= (c > 0 && differs(c - 1, r)) || (r > 0 && differs(c, r - 1));
    }
  }
  if (!has_steps_) return;
  find_heights(extent, std::max(size_ / 8, size));
  const std::vector<float> found = heights_;
  const int reach = static_cast<int>(kReach / size_);
  std::vector<float> ball, edges(3, 0);
  for (int i = -reach; i <= reach; ++i) {
    ball.push_back(static_cast<float>(i * i * size_ * size_ / (2 * kBall)));
  }
  // Edges are between cells. Then the lowest that the ball can be over each cell, its underside.
  spread(edges, 1);
  spread(ball, 1);
  spread(ball, -1);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (std::isnan(found[i])) heights_[i] = found[i];
  }
}

void RolledGround::find_heights(const Vec2& extent, double size) {
  size_ = size;
  columns_ = static_cast<int>(std::ceil(extent.x() / size_)) + 1;
  rows_ = static_cast<int>(std::ceil(extent.y() / size_)) + 1;
  heights_.clear();
  for (int r = 0; r < rows_; ++r) {
    for (int c = 0; c < columns_; ++c) {
      const auto found = ground_.at(low_.x() + c * size_, low_.y() + r * size_);
      heights_.push_back(found ? static_cast<float>(found->height)
                               : std::numeric_limits<float>::quiet_NaN());
    }
  }
}

// Each cell becomes the highest (sign 1) of what the cells beside it are less `below`, or the
// lowest (-1) of what they are and it: first along the rows, then across them.
void RolledGround::spread(std::span<const float> below, float sign) {
  const int reach = static_cast<int>(below.size() / 2);
  for (const bool along : {true, false}) {
    std::vector<float> to(heights_.size(), -sign * std::numeric_limits<float>::infinity());
    parallel_for(krok::at(rows_), 16, jobs_, [&](std::size_t begin, std::size_t end) {
      for (int r = static_cast<int>(begin); r < static_cast<int>(end); ++r) {
        for (int i = -reach; i <= reach; ++i) {
          if (!along && (r + i < 0 || r + i >= rows_)) continue;
          const int first = along ? std::max(0, -i) : 0;
          const int last = along ? std::min(columns_, columns_ - i) : columns_;
          const int from = (along ? r : r + i) * columns_ + (along ? i : 0);
          float* own = &to[krok::at(r * columns_)];
          const float lower = sign * below[krok::at(i + reach)];
          for (int c = first; c < last; ++c) {
            const float value = heights_[krok::at(from + c)] - lower;
            if (sign * value > sign * own[c]) own[c] = value;
          }
        }
      }
    });
    heights_ = std::move(to);
  }
}

double RolledGround::height(double column, double row) const {
  const int c = static_cast<int>(column), r = static_cast<int>(row);
  const double u = column - c, v = row - r;
  const auto of = [&](int x, int y) {
    return double(cell(std::min(x, columns_ - 1), std::min(y, rows_ - 1)));
  };
  return (1 - v) * ((1 - u) * of(c, r) + u * of(c + 1, r)) +
         v * ((1 - u) * of(c, r + 1) + u * of(c + 1, r + 1));
}

std::optional<GroundPoint> RolledGround::at(double x, double z, double below) const {
  auto found = ground_.at(x, z, below);
  const double column = (x - low_.x()) / size_, row = (z - low_.y()) / size_;
  const double aside = std::round(kWide / size_);
  if (!has_steps_ || !found || !(std::min(column, row) >= aside) || column > columns_ - 1 - aside ||
      row > rows_ - 1 - aside) {
    return found;
  }
  const double rolled = height(column, row);
  if (!(rolled > found->height)) return found;
  found->height = rolled;
  const Vec3 up(height(column - aside, row) - height(column + aside, row), 2 * aside * size_,
                height(column, row - aside) - height(column, row + aside));
  found->normal = up.allFinite() ? Vec3(up.normalized()) : Vec3(Vec3::UnitY());
  return found;
}

}  // namespace krok::settling
