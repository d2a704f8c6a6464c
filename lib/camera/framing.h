#pragma once

#include <span>

#include "math/transform.h"

// Camera framing. Shapes to be framed are balls, so that a joint includes the flesh around it.

namespace krok {

// A camera's view frustum, by tangents of half angles. A ball is inside if it is in front of the
// near plane and on the inner side of the four side planes.
struct ImageExtent {
  double half_height = 0.3;  // tangents of half the vertical and half the horizontal field of view
  double half_width = 0.5;
  double near_plane = 0.05;  // metres from the camera, > 0

  // `field_of_view` is vertical, radians in (0, pi); `aspect` is width / height, > 0; `margin` is
  // the fraction of height and width kept free at each edge, in [0, 0.5).
  static ImageExtent of(double field_of_view, double aspect, double margin);
};

struct Ball {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
};

// The min distance from `aim` at which a camera with this orientation (camera_to_world), looking at
// `aim`, has all balls in the image. It is negative if all balls are well behind the aim. Exact; 0
// for no balls.
double distance_to_frame(const ImageExtent& image, const Quat& orientation, const Vec3& aim,
                         std::span<const Ball> balls);

// Whether a camera has all balls in the image, with a tolerance of 1e-6 m.
bool shows_all(const ImageExtent& image, const Vec3& eye, const Quat& orientation,
               std::span<const Ball> balls);

// The camera position nearest to the balls, along its view direction, from which a camera with this
// orientation has all balls in the image; the tighter of height and width is filled, the other is
// centred. The origin for no balls. Balls can be added incrementally.
class CameraFit {
 public:
  CameraFit(const ImageExtent& image, const Quat& orientation)
      : image_(image), orientation_(orientation) {}

  void add(const Ball& ball);
  Vec3 place() const;

  // Min and max depth of the balls' centres from that position; metres.
  double nearest() const { return least_depth_ - depth(); }
  double farthest() const { return most_depth_ - depth(); }

 private:
  double depth() const;

  ImageExtent image_;
  Quat orientation_;
  bool any_ = false;
  // For the right, left, top and bottom edge and the near plane: the max forward position of the
  // camera, relative to the middle.
  double right_ = 0, left_ = 0, top_ = 0, bottom_ = 0, near_ = 0;
  double least_depth_ = 0, most_depth_ = 0;
};

}  // namespace krok
