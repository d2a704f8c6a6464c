// If this fails, the bytes of a file depend on the machine that wrote it.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "core/simd.h"
#include "formats/container/sections.h"

namespace krok {
namespace {

constexpr auto kXyz = OrientationEncoding::xyz;

// Quaternions of length 1 within rounding, some of them hard to store: w near 0, components that
// are equal or zero, both signs.
std::vector<Quatf> orientations(std::size_t count) {
  std::mt19937 engine(5);
  const auto number = [&] { return static_cast<double>(engine()) / 2147483648.0 - 1.0; };
  std::vector<Quatf> result;
  for (std::size_t i = 0; i < count; ++i) {
    const double w = i % 3 == 0 ? number() : std::pow(10.0, -8 * std::abs(number())) * number();
    Vec3 axis(number(), number(), number());
    if (i % 11 == 0) axis = Vec3::UnitY();
    if (i % 13 == 0) axis = Vec3(1, 1, 0);
    axis = axis.normalized() * std::sqrt(1 - w * w);
    result.push_back(Quat(w, axis.x(), axis.y(), axis.z()).normalized().cast<float>());
  }
  return result;
}

std::vector<std::byte> one_by_one(const std::vector<Vec3f>& positions,
                                  const std::vector<Quatf>& orientations,
                                  OrientationEncoding encoding) {
  const std::size_t size = transform_size(encoding);
  std::vector<std::byte> bytes(positions.size() * size);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    write_transform(positions[i], orientations[i].cast<double>(), encoding, &bytes[i * size]);
  }
  return bytes;
}

std::vector<std::byte> together(const std::vector<Vec3f>& positions,
                                const std::vector<Quatf>& orientations,
                                OrientationEncoding encoding) {
  std::vector<std::byte> bytes(positions.size() * transform_size(encoding));
  write_transforms(positions, orientations, encoding, bytes.data());
  for (const Simd simd : {Simd::other, Simd::avx2}) {
    std::vector<std::byte> others(bytes.size());
    limit_simd(simd);
    write_transforms(positions, orientations, encoding, others.data());
    EXPECT_EQ(bytes, others);
  }
  limit_simd(Simd::avx512);
  return bytes;
}

TEST(WriteTransforms, GivesTheBytesOfOneByOne) {
  for (const std::size_t count : {0u, 1u, 3u, 4u, 7u, 8u, 9u, 100u, 20000u}) {
    const auto q = orientations(count);
    std::vector<Vec3f> p;
    for (std::size_t i = 0; i < count; ++i) p.emplace_back(0.1f * i, -1.0f * i, 0.0f);
    for (const auto encoding : {kXyz, OrientationEncoding::xyzw}) {
      EXPECT_EQ(together(p, q, encoding), one_by_one(p, q, encoding)) << count;
    }
  }
}

TEST(WriteTransforms, GivesTheBytesOfOneByOneForWhatIsNoRotation) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float least = std::numeric_limits<float>::denorm_min();
  std::vector<Quatf> q = orientations(30);
  q[2] = Quatf(0, 0, 0, 0);
  q[5] = Quatf(nan, 0, 0, 1);
  q[8] = Quatf(0.5f, inf, 0, 0);
  q[9] = Quatf(-0.5f, 0, -inf, 0);
  q[12] = Quatf(inf, 0, 0, 0);
  q[17] = Quatf(0, least, 0, 0);
  q[18] = Quatf(-0.0f, -0.0f, 1, -0.0f);
  q[19] = Quatf(1e-4f, 2, -3, 1e30f);
  q[29] = Quatf(0, nan, nan, nan);
  const std::vector<Vec3f> p(q.size(), Vec3f(nan, 1, inf));
  EXPECT_EQ(together(p, q, kXyz), one_by_one(p, q, kXyz));
}

}  // namespace
}  // namespace krok
