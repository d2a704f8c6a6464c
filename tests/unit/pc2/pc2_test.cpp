// If these fail, other programs see other vertices in a point cache than the motion has, or a cache
// that another program wrote is read wrongly.

#include "formats/pc2/pc2.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "support/human_skeleton.h"
#include "support/mesh_motions.h"
#include "support/test_scenes.h"
#include "support/written_bytes.h"

namespace krok {
namespace {

using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Two vertices; vertex 1 goes along +Z.
Model pair() {
  Model model;
  model.positions = {Vec3f(1, 2, 3), Vec3f(0, 0, 0)};
  return model;
}
MeshMotion motion_of_pair(int frames) {
  return {frames, 30, copies_of([](int frame, const ShapeOutput& to) {
            EXPECT_TRUE(to.normals.empty());
            to.positions[0] = Vec3f(1, 2, 3);
            to.positions[1] = Vec3f(0, 0, static_cast<float>(frame));
          })};
}

std::string written(const MeshMotion& motion, const pc2::WriteOptions& options = {}) {
  return test::bytes_of(
      [&](OutputFile& file) { return pc2::write(pair(), motion, options, file); });
}
std::string code_of(const pc2::WriteOptions& options) {
  return test::error_code(
      [&](OutputFile& file) { return pc2::write(pair(), motion_of_pair(1), options, file); });
}

Result<pc2::PointCache> read(const std::string& bytes) {
  return pc2::PointCache::read(std::as_bytes(std::span(bytes)));
}
std::string read_code(const std::string& bytes) {
  const auto cache = read(bytes);
  return cache ? "none" : cache.error().code;
}

// By hand after the published layout: a signature of 12 bytes, version, vertices, start frame,
// frames a sample, samples; then x, y, z of each vertex of each sample, all of 32 bits.
const std::string kFile = std::string("POINTCACHE2\0", 12) + std::string("\1\0\0\0", 4) +
                          std::string("\2\0\0\0", 4) + std::string("\0\0\x20\x41", 4) /* 10 */ +
                          std::string("\0\0\0\x3F", 4) /* 0.5 */ + std::string("\2\0\0\0", 4) +
                          /* sample 0 */ std::string("\0\0\x80\x3F\0\0\0\x40\0\0\x40\x40", 12) +
                          std::string(12, '\0') +
                          /* sample 1 */ std::string("\0\0\x80\x3F\0\0\0\x40\0\0\x40\x40", 12) +
                          std::string(8, '\0') + std::string("\0\0\x80\x3F", 4);

TEST(Pc2, WritesThePublishedLayout) {
  pc2::WriteOptions options;
  options.start_frame = 10;
  options.frames_per_sample = 0.5;
  EXPECT_EQ(written(motion_of_pair(2), options), kFile);
}

TEST(Pc2, ReadsThePublishedLayout) {
  // From any address: a file inside another one need not begin where floats may.
  for (std::size_t shift = 0; shift < 4; ++shift) {
    const std::string shifted = std::string(shift, 'x') + kFile;
    const auto cache = pc2::PointCache::read(std::as_bytes(std::span(shifted)).subspan(shift));
    ASSERT_TRUE(cache.ok());
    EXPECT_EQ(cache->points(), 2);
    EXPECT_EQ(cache->samples(), 2);
    EXPECT_EQ(cache->start_frame(), 10);
    EXPECT_EQ(cache->frames_per_sample(), 0.5f);
    EXPECT_EQ(cache->bytes_left(), 0u);
    std::vector<Vec3f> positions(2);
    ASSERT_TRUE(cache->get(1, positions).ok());
    EXPECT_EQ(positions[0], Vec3f(1, 2, 3));
    EXPECT_EQ(positions[1], Vec3f(0, 0, 1));
    ASSERT_TRUE(cache->get(0, positions).ok());
    EXPECT_EQ(positions[1], Vec3f(0, 0, 0));
  }
}

TEST(Pc2, TurnsAndScalesForOtherAxesAndUnits) {
  pc2::WriteOptions options;
  options.up = pc2::Up::z;
  options.scale = 100;
  const std::string bytes = written(motion_of_pair(2), options);
  std::vector<Vec3f> positions(2);
  const auto cache = read(bytes);
  ASSERT_TRUE(cache.ok() && cache->get(1, positions).ok());
  // What looked along +Z with +Y up looks along -Y with +Z up, in centimetres.
  EXPECT_EQ(positions[0], Vec3f(100, -300, 200));
  EXPECT_EQ(positions[1], Vec3f(0, -100, 0));
}

TEST(Pc2, GivesBackTheMotionToTheBitWithAnyThreads) {
  const Model model = test::tube_model(test::human_skeleton());
  const MeshMotion motion = test::wobble(model, 20);
  const auto write = [&](int jobs) {
    return test::bytes_of(
        [&](OutputFile& file) { return pc2::write(model, motion, {}, file, nullptr, jobs); });
  };
  const std::string bytes = write(1);
  for (const int jobs : {2, 3, 8}) EXPECT_EQ(write(jobs), bytes) << jobs;
  const auto cache = read(bytes);
  ASSERT_TRUE(cache.ok());
  ASSERT_EQ(cache->samples(), 20);
  ASSERT_EQ(cache->points(), model.vertex_count());
  std::vector<Vec3f> expected(model.positions.size()), positions(expected.size());
  for (int f = 0; f < 20; ++f) {
    motion.source()(f, {expected, {}, {}});
    ASSERT_TRUE(cache->get(f, positions).ok());
    EXPECT_EQ(positions, expected) << f;
  }
}

TEST(Pc2, OfNoFramesOrNoVerticesIsAHeader) {
  const std::string bytes = written(motion_of_pair(0));
  EXPECT_EQ(bytes.size(), 32u);
  const auto none = read(bytes);
  ASSERT_TRUE(none.ok());
  EXPECT_EQ(none->samples(), 0);
  std::string empty = kFile.substr(0, 32);
  empty[16] = 0;  // no vertices
  const auto cache = read(empty);
  ASSERT_TRUE(cache.ok());
  EXPECT_EQ(cache->samples(), 2);
  EXPECT_TRUE(cache->get(1, {}).ok());
}

TEST(Pc2, RefusesOptionsThatTheFileCannotHold) {
  pc2::WriteOptions options;
  for (const double scale : {0.0, -1.0, 1e40, static_cast<double>(kNan)}) {
    options.scale = scale;
    EXPECT_EQ(code_of(options), "pc2-option") << scale;
  }
  options = {};
  for (const double start : {1e39, static_cast<double>(kInfinity)}) {
    options.start_frame = start;
    EXPECT_EQ(code_of(options), "pc2-option") << start;
  }
  options = {};
  for (const double each : {0.0, -2.0, 1e-60, static_cast<double>(kNan)}) {
    options.frames_per_sample = each;
    EXPECT_EQ(code_of(options), "pc2-option") << each;
  }
}

TEST(Pc2, WritesNoVertexThatIsNotFinite) {
  MeshMotion motion = motion_of_pair(4);
  motion.source = copies_of([](int frame, const ShapeOutput& to) {
    std::ranges::fill(to.positions, Vec3f::Zero());
    if (frame == 2) to.positions[1].z() = kNan;
  });
  Status status;
  test::bytes_of([&](OutputFile& file) { return pc2::write(pair(), motion, {}, file); }, status);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "pc2-value");
  EXPECT_THAT(status.error().message, HasSubstr("frame 2"));
  // One that overflows by its scale is none either.
  pc2::WriteOptions options;
  options.scale = 3e38;
  EXPECT_EQ(code_of(options), "pc2-value");
}

TEST(Pc2, TellsWhatIsWrongWithAFile) {
  EXPECT_EQ(read_code(""), "pc2-format");
  EXPECT_EQ(read_code("POINTCACHE2"), "pc2-format");
  EXPECT_EQ(read_code("POINTCACHE1" + kFile.substr(11)), "pc2-format");
  EXPECT_EQ(read_code(kFile.substr(0, 31)), "pc2-truncated");
  EXPECT_EQ(read_code(kFile.substr(0, kFile.size() - 1)), "pc2-truncated");
  const auto changed = [](std::size_t at, auto value) {
    std::string bytes = kFile;
    std::memcpy(&bytes[at], &value, sizeof value);
    return bytes;
  };
  EXPECT_EQ(read_code(changed(12, 2)), "pc2-version");
  EXPECT_EQ(read_code(changed(16, -1)), "pc2-value");
  EXPECT_EQ(read_code(changed(16, 3)), "pc2-truncated");
  EXPECT_EQ(read_code(changed(16, 0x7FFFFFFF)), "pc2-truncated");
  EXPECT_EQ(read_code(changed(28, -1)), "pc2-value");
  EXPECT_EQ(read_code(changed(28, 0x7FFFFFFF)), "pc2-truncated");
  EXPECT_EQ(read_code(changed(20, kNan)), "pc2-value");
  EXPECT_EQ(read_code(changed(24, kInfinity)), "pc2-value");
  EXPECT_EQ(read_code(changed(24, 0.0f)), "pc2-value");
  EXPECT_EQ(read_code(changed(24, -1.0f)), "pc2-value");
}

TEST(Pc2, BytesAfterTheLastSampleAreCounted) {
  const auto cache = read(kFile + "tail");
  ASSERT_TRUE(cache.ok());
  EXPECT_EQ(cache->bytes_left(), 4u);
}

TEST(Pc2, AVertexThatIsNotFiniteIsToldByItsPlace) {
  std::string bytes = kFile;
  const std::size_t at = 32 + 24 + 12 + 4;  // y of vertex 1 of sample 1
  std::memcpy(&bytes[at], &kInfinity, 4);
  const auto cache = read(bytes);
  ASSERT_TRUE(cache.ok());
  std::vector<Vec3f> positions(2);
  EXPECT_TRUE(cache->get(0, positions).ok());
  const Status status = cache->get(1, positions);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, "pc2-value");
  EXPECT_EQ(status.error().where.byte_offset, 32 + 24 + 12);
  EXPECT_THAT(status.error().message, HasSubstr("vertex 1 of sample 1"));
}

}  // namespace
}  // namespace krok
