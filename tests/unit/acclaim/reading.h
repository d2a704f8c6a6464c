#pragma once

#include <gtest/gtest.h>

#include <string>

#include "formats/acclaim/acclaim_reader.h"

// Reads Acclaim's files as the tests of the reader want it: in the file's own unit and axes.

namespace krok::acclaim::test {

inline ReadOptions plain() {
  ReadOptions options;
  options.unit = Unit{1.0, "m"};
  options.up = Direction::plus_y;
  options.forward = Direction::plus_z;
  return options;
}

inline ReadOptions strictness(Strictness strictness) {
  ReadOptions options = plain();
  options.strictness = strictness;
  return options;
}

inline Result<Capture> read(const std::string& asf, const std::string& amc,
                            const ReadOptions& options = plain()) {
  auto capture = acclaim::read(asf, "s.asf", amc, "m.amc", options);
  if (capture.ok()) {
    const Status status = check(capture->clip);
    EXPECT_TRUE(status.ok()) << status.error().message;
  }
  return capture;
}

inline Vec3 position(const Capture& capture, int frame, const char* joint) {
  const int index = capture.clip.skeleton.find(joint);
  EXPECT_GE(index, 0) << joint;
  return capture.clip.frame_positions(frame)[static_cast<std::size_t>(index)].cast<double>();
}

inline void expect_near(const Vec3& actual, const Vec3& expected) {
  EXPECT_LT((actual - expected).norm(), 1e-6)
      << actual.transpose() << " instead of " << expected.transpose();
}

inline bool told(const Capture& capture, const std::string& code, const std::string& part) {
  for (const auto& d : capture.diagnostics) {
    if (d.code == code && d.message.find(part) != std::string::npos) return true;
  }
  return false;
}

inline std::string all(const Capture& capture) {
  std::string text;
  for (const auto& d : capture.diagnostics) text += d.code + ": " + d.message + "\n";
  return text;
}

}  // namespace krok::acclaim::test
