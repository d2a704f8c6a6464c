#include "camera/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace krok {

namespace {

constexpr double kTouching = 1e-6;

// A ball in camera space.
struct Seen {
  double x = 0, y = 0, depth = 0;
};

Seen seen(const Quat& orientation, const Vec3& offset) {
  const Vec3 place = orientation.conjugate() * offset;
  return {place.x(), place.y(), -place.z()};
}

// The ball's extent along the depth axis at a side plane with half-angle tangent `half`.
double reach(double half, double radius) {
  return radius * std::sqrt(1 + half * half);
}

}  // namespace

ImageExtent ImageExtent::of(double field_of_view, double aspect, double margin) {
  const double whole = std::tan(field_of_view / 2);
  ImageExtent image;
  image.half_height = whole * (1 - 2 * margin);
  image.half_width = whole * aspect * (1 - 2 * margin);
  return image;
}

double distance_to_frame(const ImageExtent& image, const Quat& orientation, const Vec3& aim,
                         std::span<const Ball> balls) {
  if (balls.empty()) return 0;
  double distance = -std::numeric_limits<double>::infinity();
  for (const Ball& ball : balls) {
    const Seen at = seen(orientation, ball.centre - aim);
    // |x| + radius / cos <= (distance + depth) tan, and the same for y.
    const double across =
        (std::abs(at.x) + reach(image.half_width, ball.radius)) / image.half_width;
    const double up = (std::abs(at.y) + reach(image.half_height, ball.radius)) / image.half_height;
    const double near = ball.radius + image.near_plane;
    distance = std::max(distance, std::max({across, up, near}) - at.depth);
  }
  return distance;
}

bool shows_all(const ImageExtent& image, const Vec3& eye, const Quat& orientation,
               std::span<const Ball> balls) {
  return balls.empty() || distance_to_frame(image, orientation, eye, balls) <= kTouching;
}

void CameraFit::add(const Ball& ball) {
  const Seen at = seen(orientation_, ball.centre);
  const double width = image_.half_width, height = image_.half_height;
  // x - cx + radius / cos <= (depth - c) tan, which is c + (-cx) / tan <= depth - (x + ...) / tan.
  const double right = at.depth - (at.x + reach(width, ball.radius)) / width;
  const double left = at.depth - (-at.x + reach(width, ball.radius)) / width;
  const double top = at.depth - (at.y + reach(height, ball.radius)) / height;
  const double bottom = at.depth - (-at.y + reach(height, ball.radius)) / height;
  const double near = at.depth - ball.radius - image_.near_plane;
  right_ = any_ ? std::min(right_, right) : right;
  left_ = any_ ? std::min(left_, left) : left;
  top_ = any_ ? std::min(top_, top) : top;
  bottom_ = any_ ? std::min(bottom_, bottom) : bottom;
  near_ = any_ ? std::min(near_, near) : near;
  least_depth_ = any_ ? std::min(least_depth_, at.depth) : at.depth;
  most_depth_ = any_ ? std::max(most_depth_, at.depth) : at.depth;
  any_ = true;
}

double CameraFit::depth() const {
  return std::min({(right_ + left_) / 2, (top_ + bottom_) / 2, near_});
}

Vec3 CameraFit::place() const {
  if (!any_) return Vec3::Zero();
  const double x = (left_ - right_) / 2 * image_.half_width;
  const double y = (bottom_ - top_) / 2 * image_.half_height;
  return orientation_ * Vec3(x, y, -depth());
}

}  // namespace krok
