#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

#include "rbf/inverse.h"

// A motion whose parameters have a closed form: a planar arm. An example is its joint angles, a
// blend is their weighted sum, and the parameters are up to four of hand position, elbow height and
// hand angle.

namespace krok::test {

struct Arm {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8>;

  static constexpr Eigen::Index kElbow = 1;                   // the joint whose link ends there
  std::vector<double> links = {0.35, 0.35, 0.3, 0.25, 0.15};  // metres
  int dimensions = 2;              // the first of: hand x, hand y, elbow y, hand angle
  Eigen::MatrixXd angles;          // [joints x examples], radians
  std::vector<double> parameters;  // [examples x dimensions], measured

  Eigen::Index joints() const { return static_cast<Eigen::Index>(links.size()); }

  // The parameters of a pose, and their derivatives by its angles, [dimensions x joints].
  Vector measure_pose(const Vector& pose, Matrix* slopes) const {
    Eigen::Vector4d all = Eigen::Vector4d::Zero();
    Matrix by_angle = Matrix::Zero(4, joints());
    double heading = 0;
    for (Eigen::Index j = 0; j < joints(); ++j) {
      const double length = links[static_cast<std::size_t>(j)];
      heading += pose[j];
      all[0] += length * std::cos(heading);
      all[1] += length * std::sin(heading);
      if (j <= kElbow) all[2] += length * std::sin(heading);
      for (Eigen::Index k = 0; k <= j; ++k) {
        by_angle(0, k) -= length * std::sin(heading);
        by_angle(1, k) += length * std::cos(heading);
        if (j <= kElbow) by_angle(2, k) += length * std::cos(heading);
      }
    }
    all[3] = heading;
    by_angle.row(3).setOnes();
    if (slopes != nullptr) *slopes = by_angle.topRows(dimensions);
    return all.head(dimensions);
  }

  rbf::Measure measure() const {
    return [this](std::span<const double> weights, std::span<double> out,
                  std::span<double> jacobian) -> Status {
      const Eigen::Map<const Eigen::VectorXd> w(weights.data(), angles.cols());
      Matrix slopes;
      const Vector found = measure_pose(angles * w, jacobian.empty() ? nullptr : &slopes);
      for (Eigen::Index a = 0; a < dimensions; ++a) out[static_cast<std::size_t>(a)] = found[a];
      if (!jacobian.empty()) {
        Eigen::Map<RowMajor>(jacobian.data(), dimensions, angles.cols()) = slopes * angles;
      }
      return {};
    };
  }
};

// Examples on a grid of `steps` along each parameter; degrees of freedom that the parameters leave
// open are random. Parameter ranges are about 0.4 m and 50 degrees.
inline Arm make_arm(int dimensions, int steps, unsigned seed = 1) {
  Arm arm;
  arm.dimensions = dimensions;
  const double middle[4] = {0.85, 0.35, 0.42, -0.3}, half[4] = {0.18, 0.18, 0.1, 0.4};
  std::mt19937 random(seed);
  int count = 1;
  for (int i = 0; i < dimensions; ++i) count *= steps;
  arm.angles.resize(arm.joints(), count);
  for (int e = 0; e < count; ++e) {
    Arm::Vector wanted(dimensions);
    for (int i = 0, rest = e; i < dimensions; ++i, rest /= steps) {
      wanted[i] = middle[i] + half[i] * (2.0 * (rest % steps) / (steps - 1) - 1);
    }
    Arm::Vector pose(arm.joints());
    pose << 1.1, -0.7, -0.3, -0.2, -0.2;
    for (Eigen::Index j = 0; j < pose.size(); ++j) pose[j] += 0.1 * (random() % 2001 / 1e3 - 1);
    for (int step = 0; step < 60; ++step) {
      Arm::Matrix slopes;
      const Arm::Vector off = wanted - arm.measure_pose(pose, &slopes);
      const Arm::Matrix normal =
          slopes * slopes.transpose() + 1e-6 * Arm::Matrix::Identity(dimensions, dimensions);
      pose += slopes.transpose() * normal.ldlt().solve(off);
    }
    arm.angles.col(e) = pose;
    const Arm::Vector found = arm.measure_pose(pose, nullptr);
    arm.parameters.insert(arm.parameters.end(), found.data(), found.data() + found.size());
  }
  return arm;
}

}  // namespace krok::test
