// If these fail, a vertex that is no number gets into a file, or a file's bounds are not those of
// its vertices, or are others on another machine.

#include "math/vector_arrays.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "core/simd.h"
#include "support/special_values.h"

namespace krok {
namespace {

using test::kInfinityF;
using test::kNanF;

// Runs the rest of a block with at most these instructions.
class WithSimd {
 public:
  explicit WithSimd(Simd most) { limit_simd(most); }
  ~WithSimd() { limit_simd(Simd::avx512); }
};
constexpr Simd kAll[] = {Simd::other, Simd::avx2, Simd::avx512};

std::vector<Vec3f> random_vectors(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> number(-100.0f, 100.0f);
  std::vector<Vec3f> vectors(count);
  for (Vec3f& vector : vectors) {
    vector.x() = number(random);
    vector.y() = number(random);
    vector.z() = number(random);
  }
  return vectors;
}

bool same_bits(const Vec3f& a, const Vec3f& b) {
  for (int i = 0; i < 3; ++i) {
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i])) return false;
  }
  return true;
}

TEST(AllFinite, FindsOneAmongMany) {
  for (const Simd simd : kAll) {
    const WithSimd with(simd);
    std::vector<Vec3f> vectors(37, Vec3f(3.4e38f, -3.4e38f, 1e-45f));
    EXPECT_TRUE(all_finite(vectors));
    EXPECT_TRUE(all_finite(std::span<const Vec3f>()));
    EXPECT_TRUE(all_finite(std::span<const Vec4f>()));
    for (std::size_t v = 0; v < vectors.size(); ++v) {
      for (const float bad : {kInfinityF, -kInfinityF, kNanF, -kNanF}) {
        const Vec3f was = vectors[v];
        vectors[v][static_cast<int>(v % 3)] = bad;
        EXPECT_FALSE(all_finite(vectors)) << v << " " << bad;
        vectors[v] = was;
      }
    }
    std::vector<Vec4f> tangents(37, Vec4f(0, 1, 0, -1));
    for (Vec4f& tangent : tangents) {
      EXPECT_TRUE(all_finite(tangents));
      tangent.w() = kNanF;
      EXPECT_FALSE(all_finite(tangents));
      tangent.w() = 1;
    }
  }
}

TEST(Subtract, GivesTheBitsOfThePlainVersionTailsIncluded) {
  for (std::size_t count = 0; count <= 70; ++count) {
    const auto base = random_vectors(count, 1), vectors = random_vectors(count, 2);
    std::vector<Vec3f> expected = vectors;
    VectorBounds bounds = vector_arrays_detail::no_bounds();
    vector_arrays_detail::subtract(base, expected, bounds);
    for (const Simd simd : kAll) {
      const WithSimd with(simd);
      std::vector<Vec3f> result = vectors;
      const VectorBounds found = subtract(base, result);
      EXPECT_TRUE(found.finite);
      EXPECT_TRUE(same_bits(found.least, bounds.least)) << count;
      EXPECT_TRUE(same_bits(found.most, bounds.most)) << count;
      for (std::size_t v = 0; v < count; ++v) {
        ASSERT_TRUE(same_bits(result[v], expected[v])) << count << " " << v;
      }
    }
  }
}

TEST(Subtract, TellsWhatIsNotFinite) {
  for (const Simd simd : kAll) {
    const WithSimd with(simd);
    for (std::size_t bad = 0; bad < 37; ++bad) {
      std::vector<Vec3f> base = random_vectors(37, 1), vectors = random_vectors(37, 2);
      // Their difference is too large for a float.
      base[bad].z() = -3e38f;
      vectors[bad].z() = 3e38f;
      EXPECT_FALSE(subtract(base, vectors).finite) << bad;
    }
  }
}

// Bounds are written as text, where the sign would show.
TEST(Subtract, BoundsOfZerosHaveNoSign) {
  for (const Simd simd : kAll) {
    const WithSimd with(simd);
    for (const std::size_t count : {1u, 16u, 37u}) {
      const std::vector<Vec3f> base(count, Vec3f::Zero());
      std::vector<Vec3f> vectors(count, Vec3f::Constant(-0.0f));
      vectors[count / 2] = Vec3f::Zero();
      const VectorBounds bounds = subtract(base, vectors);
      for (int i = 0; i < 3; ++i) {
        EXPECT_FALSE(std::signbit(bounds.least[i])) << count;
        EXPECT_FALSE(std::signbit(bounds.most[i])) << count;
      }
    }
  }
}

TEST(Subtract, OfNothingGivesNoBox) {
  const VectorBounds bounds = subtract({}, {});
  EXPECT_TRUE(bounds.finite);
  EXPECT_EQ(bounds.least, Vec3f::Constant(kInfinityF));
  EXPECT_EQ(bounds.most, Vec3f::Constant(-kInfinityF));
}

}  // namespace
}  // namespace krok
