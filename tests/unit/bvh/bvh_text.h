#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/bvh/bvh_writer.h"

// Small BVH texts for tests.

namespace krok::bvh {

// A root with position channels and an arm of two joints, 9 + 3 channels.
inline const std::string kArm =
    "HIERARCHY\n"
    "ROOT Root\n"
    "{\n"
    "  OFFSET 0 0 0\n"
    "  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    "  JOINT Elbow\n"
    "  {\n"
    "    OFFSET 1 0 0\n"
    "    CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "    End Site\n"
    "    {\n"
    "      OFFSET 2 0 0\n"
    "    }\n"
    "  }\n"
    "}\n";

inline std::string motion(int frames, const std::string& rows, const std::string& time = "0.1") {
  return "MOTION\nFrames: " + std::to_string(frames) + "\nFrame Time: " + time + "\n" + rows;
}

// Without conversion.
inline ReadOptions plain_options() {
  ReadOptions options;
  options.unit = Unit{};
  options.up = Direction::plus_y;
  options.forward = Direction::plus_z;
  options.positions = Positions::absolute;
  return options;
}

inline ReadOptions with(Strictness strictness) {
  ReadOptions options = plain_options();
  options.strictness = strictness;
  return options;
}

inline Capture read_ok(const std::string& text, const ReadOptions& options = plain_options()) {
  auto capture = read(text, "test.bvh", options);
  EXPECT_TRUE(capture.ok()) << capture.error().message;
  return capture.ok() ? std::move(*capture) : Capture();
}

inline Error read_error(const std::string& text, const ReadOptions& options = plain_options()) {
  const auto capture = read(text, "test.bvh", options);
  EXPECT_FALSE(capture.ok());
  return capture.ok() ? Error() : capture.error();
}

inline const Diagnostic* find(const Diagnostics& diagnostics, const std::string& code) {
  for (const Diagnostic& diagnostic : diagnostics) {
    if (diagnostic.code == code) return &diagnostic;
  }
  return nullptr;
}

// Of a Clip or a FrameSource.
template <typename Motion>
std::string written(const Motion& motion, const WriteOptions& options = WriteOptions()) {
  const std::string path =
      testing::TempDir() + "krok_unit_bvh_" + std::to_string(getpid()) + ".bvh";
  auto file = OutputFile::create(path);
  EXPECT_TRUE(file.ok());
  const Status status = write(motion, options, *file);
  EXPECT_TRUE(status.ok()) << status.error().message;
  EXPECT_TRUE(file->commit().ok());
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  in.close();
  std::filesystem::remove(path);
  return text.str();
}

}  // namespace krok::bvh
