// Would fail if a vertex landed elsewhere than linear blend skinning puts it, or if the SIMD
// kernel, an instruction set or a number of threads changed a single bit of the result.

#include "support/linear_blend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <random>

#include "core/simd.h"
#include "skin/palette.h"
#include "support/test_scenes.h"

namespace krok::test {
namespace {

// Vertices that own their data, random.
struct Vertices {
  std::vector<Vec3f> positions, normals;
  std::vector<std::uint16_t> joints;
  std::vector<float> weights;
  int influences = 4;

  SkinVertices view() const { return {positions, normals, influences, joints, weights}; }
};

struct Blended {
  std::vector<Vec3f> positions, normals;
  explicit Blended(const SkinVertices& in)
      : positions(in.positions.size(), Vec3f::Constant(-7)),
        normals(in.normals.size(), Vec3f::Constant(-7)) {}
  SkinnedVertices view() { return {positions, normals}; }
};

Vertices random_vertices(std::size_t count, int influences, int joints, unsigned seed) {
  std::mt19937 random(seed);
  const auto unit = [&] { return static_cast<float>(random() % 20001) / 10000.0f - 1.0f; };
  Vertices result;
  result.influences = influences;
  for (std::size_t v = 0; v < count; ++v) {
    result.positions.emplace_back(unit(), unit(), unit());
    result.normals.emplace_back(unit(), unit(), unit());
    float sum = 0;
    for (int k = 0; k < influences; ++k) {
      result.joints.push_back(static_cast<std::uint16_t>(random() % static_cast<unsigned>(joints)));
      result.weights.push_back(unit() + 1.001f);
      sum += result.weights.back();
    }
    for (int k = 0; k < influences; ++k) {
      result.weights[result.weights.size() - 1 - static_cast<std::size_t>(k)] /= sum;
    }
  }
  return result;
}

std::vector<SkinMatrix> palette_of(const Clip& clip, int frame) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(frame, pose);
  std::vector<SkinMatrix> palette(pose.size());
  make_palette(inverse_reference(clip.skeleton), pose, palette);
  return palette;
}

Clip human_clip() {
  return test::swinging_clip(test::with_turned_joints(test::human_skeleton()), 8, 10);
}

// Bit for bit, so that NaN and -0 count too.
testing::AssertionResult same_bits(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  for (std::size_t v = 0; v < a.size(); ++v) {
    for (int i = 0; i < 3; ++i) {
      if (std::bit_cast<std::uint32_t>(a[v][i]) != std::bit_cast<std::uint32_t>(b[v][i])) {
        return testing::AssertionFailure()
               << "vertex " << v << ": " << a[v].transpose() << " and " << b[v].transpose();
      }
    }
  }
  return testing::AssertionSuccess();
}

void expect_same(const std::vector<SkinMatrix>& palette, const SkinVertices& in,
                 const std::string& what) {
  Blended expected(in);
  linear_blend_reference(palette, in, expected.view());
  for (const Simd simd : {Simd::other, Simd::avx2, Simd::avx512}) {
    limit_simd(simd);
    Blended result(in);
    linear_blend(palette, in, result.view());
    EXPECT_TRUE(same_bits(expected.positions, result.positions)) << what;
    EXPECT_TRUE(same_bits(expected.normals, result.normals)) << what;
  }
  limit_simd(Simd::avx512);
}

TEST(LinearBlend, SimdGivesTheBitsOfTheReferenceTailsIncluded) {
  const auto palette = palette_of(human_clip(), 5);
  for (int influences = 1; influences <= Model::kMaxInfluences; ++influences) {
    for (std::size_t count = 0; count <= 35; ++count) {
      const auto in = random_vertices(count, influences, static_cast<int>(palette.size()), 7u);
      expect_same(palette, in.view(),
                  std::to_string(count) + " vertices, " + std::to_string(influences));
    }
  }
  // Across the borders of the kernel's blocks.
  for (const std::size_t count : {511u, 512u, 513u, 1025u, 3000u}) {
    const auto in = random_vertices(count, 4, static_cast<int>(palette.size()), 8u);
    expect_same(palette, in.view(), std::to_string(count) + " vertices");
  }
}

TEST(LinearBlend, SimdGivesTheBitsOfTheReferenceForOddNormals) {
  const auto palette = palette_of(human_clip(), 3);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3f> odd = {{0, 0, 0},         {1e-20f, 0, 0},    {0, 1e-12f, 0},
                                  {3e7f, -2e7f, 1},  {1e20f, 0, 0},     {kNan, 0, 0},
                                  {0, kInfinity, 0}, {-0.0f, 0, -0.0f}, {0, 0, 1e-38f}};
  for (const std::size_t place : {0u, 3u, 15u, 16u, 20u}) {
    for (const Vec3f& normal : odd) {
      auto in = random_vertices(21, 4, static_cast<int>(palette.size()), 9u);
      in.normals[place] = normal;
      expect_same(palette, in.view(), "an odd normal");
    }
  }
}

TEST(LinearBlend, NormalsComeOutWithLengthOne) {
  const auto palette = palette_of(human_clip(), 3);
  auto in = random_vertices(40, 4, static_cast<int>(palette.size()), 9u);
  in.normals[3].setZero();
  in.normals[17] = {std::numeric_limits<float>::quiet_NaN(), 0, 0};
  in.normals[20] = {1e-14f, 0, 0};
  in.normals[21] = {1e14f, 3, 0};
  Blended out(in.view());
  linear_blend(palette, in.view(), out.view());
  for (const Vec3f& normal : out.normals) EXPECT_NEAR(normal.norm(), 1.0f, 3e-7f);
  EXPECT_EQ(out.normals[3], Vec3f::UnitY());
  EXPECT_EQ(out.normals[17], Vec3f::UnitY());
}

TEST(LinearBlend, NormalsThatCancelFollowTheFirstInfluence) {
  // Half a turn about x and none: half each sends the y axis to zero.
  std::vector<Transform> pose(2);
  pose[1].orientation = Quat(0, 1, 0, 0);
  std::vector<SkinMatrix> palette(2);
  make_palette(std::vector<Transform>(2), pose, palette);
  Vertices in;
  in.influences = 2;
  in.positions = {{0, 0, 0}};
  in.normals = {{0, 2, 0}};
  in.joints = {1, 0};
  in.weights = {0.5f, 0.5f};
  Blended out(in.view());
  linear_blend(palette, in.view(), out.view());
  EXPECT_LT((out.normals[0] - Vec3f(0, -1, 0)).norm(), 1e-6f);
  expect_same(palette, in.view(), "cancelling");
}

TEST(LinearBlend, ThreadsDoNotChangeABit) {
  const auto palette = palette_of(human_clip(), 6);
  const auto in = random_vertices(10007, 4, static_cast<int>(palette.size()), 11u);
  Blended one(in.view()), many(in.view());
  linear_blend_parallel(palette, in.view(), one.view(), 1);
  linear_blend_parallel(palette, in.view(), many.view(), 4);
  EXPECT_TRUE(same_bits(one.positions, many.positions));
  EXPECT_TRUE(same_bits(one.normals, many.normals));
}

TEST(LinearBlend, WithoutNormalsPositionsAreTheSame) {
  const auto palette = palette_of(human_clip(), 6);
  auto in = random_vertices(33, 4, static_cast<int>(palette.size()), 12u);
  Blended with(in.view());
  linear_blend(palette, in.view(), with.view());
  in.normals.clear();
  Blended without(in.view());
  linear_blend(palette, in.view(), without.view());
  EXPECT_TRUE(same_bits(with.positions, without.positions));
}

// In doubles, straight from the formula.
Vec3 by_formula(const Model& model, std::span<const Transform> pose, std::size_t v) {
  Vec3 sum = Vec3::Zero();
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  for (std::size_t k = v * places; k < (v + 1) * places; ++k) {
    const std::size_t j = model.influence_joints[k];
    const Vec3 local = model.skeleton.reference[j].inverse() * model.positions[v].cast<double>();
    sum += double{model.influence_weights[k]} * (pose[j] * local);
  }
  return sum;
}

TEST(LinearBlend, AgreesWithTheFormulaInDoubles) {
  const Clip clip = human_clip();
  for (const int influences : {1, 2, 4, 8}) {
    const Model model = test::tube_model(clip.skeleton, influences);
    for (int f = 0; f < clip.frame_count(); ++f) {
      std::vector<Transform> pose(clip.skeleton.names.size());
      clip.get_pose(f, pose);
      Blended out(skin_vertices(model));
      linear_blend(palette_of(clip, f), skin_vertices(model), out.view());
      for (std::size_t v = 0; v < model.positions.size(); ++v) {
        ASSERT_LT((out.positions[v].cast<double>() - by_formula(model, pose, v)).norm(), 1e-6);
      }
    }
  }
}

TEST(LinearBlend, ReferencePoseGivesTheReferenceMesh) {
  const Skeleton skeleton = test::with_turned_joints(test::human_skeleton());
  const Model model = test::tube_model(skeleton);
  std::vector<SkinMatrix> palette(skeleton.names.size());
  make_palette(inverse_reference(skeleton), skeleton.reference, palette);
  Blended out(skin_vertices(model));
  linear_blend(palette, skin_vertices(model), out.view());
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    EXPECT_LT((out.positions[v] - model.positions[v]).norm(), 5e-7f);
    EXPECT_LT((out.normals[v] - model.normals[v]).norm(), 5e-7f);
  }
}

TEST(LinearBlend, RigidMotionOfTheSkeletonMovesTheMeshRigidly) {
  const Skeleton skeleton = test::with_turned_joints(test::human_skeleton());
  const Model model = test::tube_model(skeleton);
  const Transform move{Vec3(3, -2, 5), from_rotation_vector(Vec3(0.4, -2.0, 0.9))};
  std::vector<Transform> pose;
  for (const Transform& joint : skeleton.reference) pose.push_back(move * joint);
  std::vector<SkinMatrix> palette(pose.size());
  make_palette(inverse_reference(skeleton), pose, palette);
  Blended out(skin_vertices(model));
  linear_blend(palette, skin_vertices(model), out.view());
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    const Vec3 expected = move * model.positions[v].cast<double>();
    const Vec3 normal = move.orientation * model.normals[v].cast<double>();
    EXPECT_LT((out.positions[v].cast<double>() - expected).norm(), 2e-6);
    EXPECT_LT((out.normals[v].cast<double>() - normal).norm(), 1e-6);
  }
}

TEST(LinearBlend, OneInfluenceMovesVerticesWithTheirJoint) {
  const Clip clip = human_clip();
  const Model rigid = test::tube_model(clip.skeleton, 1);
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(7, pose);
  Blended out(skin_vertices(rigid));
  linear_blend(palette_of(clip, 7), skin_vertices(rigid), out.view());
  for (std::size_t v = 0; v < rigid.positions.size(); ++v) {
    const std::size_t j = rigid.influence_joints[v];
    const Transform moved = pose[j] * rigid.skeleton.reference[j].inverse();
    EXPECT_LT((out.positions[v].cast<double>() - moved * rigid.positions[v].cast<double>()).norm(),
              2e-6);
  }
  // The same weights spread over four places, three of them empty, change no bit.
  Vertices spread;
  spread.positions = rigid.positions;
  spread.normals = rigid.normals;
  for (std::size_t v = 0; v < rigid.positions.size(); ++v) {
    for (int k = 0; k < 4; ++k) {
      spread.joints.push_back(k == 0 ? rigid.influence_joints[v] : std::uint16_t{0});
      spread.weights.push_back(k == 0 ? 1.0f : 0.0f);
    }
  }
  Blended four(spread.view());
  linear_blend(palette_of(clip, 7), spread.view(), four.view());
  EXPECT_THAT(four.positions, testing::ContainerEq(out.positions));
}

}  // namespace
}  // namespace krok::test
