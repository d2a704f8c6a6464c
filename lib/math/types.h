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

}  // namespace krok
