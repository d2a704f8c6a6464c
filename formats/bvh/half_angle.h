#pragma once

namespace krok::bvh {

// Sine and cosine of half an angle, as used in quaternions.
struct HalfAngle {
  double sine = 0, cosine = 1;
};

// `degrees` is any finite number. Error about 1e-16: whole quarter turns are subtracted in degrees,
// which is exact, and the rest (at most 45 degrees of half angle) is evaluated with polynomials.
// Exact for multiples of 180 degrees. Uses additions and multiplications only, so that the
// vectorised version is bit-identical.
HalfAngle half_angle(double degrees);

// The angle in degrees modulo 720; half_angle() applies it to angles beyond kFarthestAngle.
double near_angle(double degrees);

// Constants shared with the vectorised version.
namespace half_angle_detail {

inline constexpr double kFarthestAngle = 1e6;
inline constexpr double kHalfTurns = 1.0 / 180.0;
inline constexpr double kHalfRadians = 0x1.1df46a2529d39p-7;  // pi / 360
// Adding and subtracting it rounds a number to the nearest integer; the lowest bits of the sum are
// those of the integer.
inline constexpr double kRounder = 0x1.8p52;

// sin(t) = t + t^3 P(t^2) and cos(t) = 1 - t^2 / 2 + t^4 Q(t^2) for |t| <= pi / 4, highest power
// first: Chebyshev interpolation (J. Mason and D. Handscomb, "Chebyshev polynomials", 2003, ch. 6)
// computed with 60 digits; max error 2e-17 of P, 1e-18 of Q.
inline constexpr double kSine[6] = {0x1.5e0b19f38405ap-33, -0x1.ae600b02a7c74p-26,
                                    0x1.71de37968a024p-19, -0x1.a01a019e83aaep-13,
                                    0x1.1111111110bb2p-7,  -0x1.5555555555555p-3};
inline constexpr double kCosine[6] = {-0x1.907da36274fc5p-37, 0x1.1eeb68e934339p-29,
                                      -0x1.27e4fa17da030p-22, 0x1.a01a019f4eb00p-16,
                                      -0x1.6c16c16c16967p-10, 0x1.5555555555555p-5};

}  // namespace half_angle_detail

}  // namespace krok::bvh
