// If these fail, angles in radians are read as degrees in silence, so that a figure hardly moves,
// or a quiet motion in degrees is called radians.

#include <cmath>

#include "math/quaternion.h"
#include "unit/bvh/bvh_text.h"

namespace krok::bvh {
namespace {

// The arm swings by up to `size` in all its six angles.
std::string swinging(double size) {
  std::string rows;
  for (int frame = 0; frame < 20; ++frame) {
    rows += "0 1 0";
    for (int channel = 0; channel < 6; ++channel) {
      rows += " " + std::to_string(size * std::sin(0.5 * frame + channel));
    }
    rows += "\n";
  }
  return kArm + motion(20, rows);
}

TEST(Angles, ThatMayBeRadiansAreAWarning) {
  for (const double size : {1.2, 3.1, 6.2}) {
    const Capture capture = read_ok(swinging(size));
    const Diagnostic* told = find(capture.diagnostics, "bvh-angles");
    ASSERT_NE(told, nullptr) << size;
    EXPECT_EQ(told->severity, Severity::warning);
    EXPECT_NE(told->hint.find("--angles radians"), std::string::npos);
  }
  for (const double size : {0.0, 0.2, 7.0, 90.0}) {
    EXPECT_EQ(find(read_ok(swinging(size)).diagnostics, "bvh-angles"), nullptr) << size;
  }
}

TEST(Angles, AreReadAsRadiansWhereTheUserSaysSo) {
  ReadOptions options = plain_options();
  options.angles = Angles::radians;
  const Capture radians = read_ok(swinging(1.2), options);
  EXPECT_EQ(find(radians.diagnostics, "bvh-angles"), nullptr);
  const Capture degrees = read_ok(swinging(1.2 / kRadiansPerDegree));
  for (std::size_t i = 0; i < degrees.clip.orientations.size(); ++i) {
    ASSERT_LT(angle_between(radians.clip.orientations[i].cast<double>(),
                            degrees.clip.orientations[i].cast<double>()),
              3e-6);  // six decimals of six angles
  }
}

TEST(FrameRate, ThatNoCaptureIsMadeAtIsAWarning) {
  const std::string row = "0 0 0 0 0 0 0 0 0\n";
  for (const char* time : {"30", "120.0", "33.3333", "1"}) {
    const Capture capture = read_ok(kArm + motion(1, row, time));
    const Diagnostic* told = find(capture.diagnostics, "bvh-rate");
    ASSERT_NE(told, nullptr);
    EXPECT_EQ(told->severity, Severity::warning) << time;
    EXPECT_EQ(capture.rate.confidence, Confidence::guess);
  }
}

}  // namespace
}  // namespace krok::bvh
