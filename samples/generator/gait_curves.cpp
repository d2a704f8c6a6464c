#include "samples/generator/gait_curves.h"

#include <array>
#include <cmath>

namespace krok::samples {

namespace {

// Degrees at 0, 5, 10 ... 95 % of the stride.
constexpr std::array<double, 20> kKnee = {4,  10, 16, 18, 17, 14, 11, 8,  6,  7,
                                          11, 20, 34, 50, 60, 61, 53, 38, 20, 7};
constexpr std::array<double, 20> kShoulder = {-20, -20, -18, -15, -11, -7, -3, 1,   5,   8,
                                              9,   9,   7,   4,   0,   -4, -9, -13, -17, -19};
constexpr std::array<double, 20> kElbow = {20, 19, 18, 18, 19, 21, 24, 28, 32, 36,
                                           38, 38, 36, 33, 30, 27, 25, 23, 22, 21};

}  // namespace

double knee_flexion(double phase) {
  static const PeriodicCurve curve(kKnee, 6);
  return curve(phase) * kRadiansPerDegree;
}

double shoulder_flexion(double phase) {
  static const PeriodicCurve curve(kShoulder, 3);
  return curve(phase) * kRadiansPerDegree;
}

double elbow_flexion(double phase) {
  static const PeriodicCurve curve(kElbow, 3);
  return curve(phase) * kRadiansPerDegree;
}

double pelvis_rotation(double left_phase) {
  // The side of the striking foot is forward.
  return -4.5 * kRadiansPerDegree * std::cos(2 * kPi * left_phase);
}

double pelvis_list(double left_phase) {
  // The side of the foot that leaves the ground drops, with the peak shortly after toe-off.
  return 3.5 * kRadiansPerDegree * std::sin(2 * kPi * (left_phase + 0.06));
}

}  // namespace krok::samples
