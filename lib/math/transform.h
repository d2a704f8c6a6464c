#pragma once

#include "math/types.h"

namespace krok {

// A rigid transform: x -> orientation * x + position. A transform named a_to_b maps coordinates in
// frame a to frame b; joint_to_world is a joint's global transform.
struct Transform {
  Vec3 position = Vec3::Zero();         // metres
  Quat orientation = Quat::Identity();  // unit

  Vec3 operator*(const Vec3& point) const { return orientation * point + position; }

  // (b_to_c * a_to_b) is a_to_c.
  Transform operator*(const Transform& first) const {
    return {orientation * first.position + position, orientation * first.orientation};
  }

  Transform inverse() const {
    const Quat back = orientation.conjugate();
    return {-(back * position), back};
  }

  Mat4 matrix() const {
    Mat4 m = Mat4::Identity();
    m.topLeftCorner<3, 3>() = orientation.toRotationMatrix();
    m.topRightCorner<3, 1>() = position;
    return m;
  }
};

}  // namespace krok
