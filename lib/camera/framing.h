#pragma once

#include <span>

#include "math/types.h"

// What fits into a picture. The shapes to be shown are balls, so that a joint takes the flesh about
// it along.

namespace krok {

// What a camera sees, by half its angles. A ball is within it if it lies before the near plane and
// on the inner side of the four planes through the camera and the picture's edges.
struct ImageExtent {
  double half_height = 0.3;  // tangents of half the vertical and half the horizontal field of view
  double half_width = 0.5;
  double near_plane = 0.05;  // metres from the camera, > 0

  // `field_of_view` is vertical, radians in (0, pi); `aspect` is width by height, > 0; `margin` the
  // part of height and of width that stays free at each edge, 0 or more and under 0.5.
  static ImageExtent of(double field_of_view, double aspect, double margin);
};

struct Ball {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
};

// The least distance from `aim` at which a camera with this orientation (camera_to_world), which
// has `aim` straight before it, has all balls in the picture. It may be negative, where all lie
// well behind the aim. Exact; 0 for no balls.
double distance_to_frame(const ImageExtent& image, const Quat& orientation, const Vec3& aim,
                         std::span<const Ball> balls);

// Whether a camera has all balls in the picture, up to a millionth of a metre.
bool shows_all(const ImageExtent& image, const Vec3& eye, const Quat& orientation,
               std::span<const Ball> balls);

// The place nearest to the balls, along the direction it looks in, from which a camera with this
// orientation has all in the picture; the larger of height and width is then filled, the other
// centred. The origin for no balls. The balls may be given bit by bit.
class CameraFit {
 public:
  CameraFit(const ImageExtent& image, const Quat& orientation)
      : image_(image), orientation_(orientation) {}

  void add(const Ball& ball);
  Vec3 place() const;

  // The largest depth of a ball's centre before that place, and the least; metres.
  double nearest() const { return least_depth_ - depth(); }
  double farthest() const { return most_depth_ - depth(); }

 private:
  double depth() const;

  ImageExtent image_;
  Quat orientation_;
  bool any_ = false;
  // For the edges at the right, left, top and bottom, and the near plane: how far forward the
  // camera may stand, taken at the middle.
  double right_ = 0, left_ = 0, top_ = 0, bottom_ = 0, near_ = 0;
  double least_depth_ = 0, most_depth_ = 0;
};

}  // namespace krok
