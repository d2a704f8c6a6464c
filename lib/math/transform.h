#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <numbers>

// Short names for vectors and quaternions. Column vectors; double where accuracy matters, float
// (suffix f) where throughput does.

namespace krok {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Vec4 = Eigen::Vector4d;
using Mat3 = Eigen::Matrix3d;
using Mat4 = Eigen::Matrix4d;
using Quat = Eigen::Quaterniond;

using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
using Vec4f = Eigen::Vector4f;
using Mat4f = Eigen::Matrix4f;
using Quatf = Eigen::Quaternionf;

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kRadiansPerDegree = kPi / 180.0;

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
