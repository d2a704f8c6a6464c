// Would fail if a kernel, an instruction set, a number of threads or the way in which influences
// are prepared changed a single bit of what the scalar reference makes.

#include "core/simd.h"
#include "skinned.h"
#include "support/linear_blend.h"

namespace krok::test {
namespace {

constexpr int kManyJoints = 23;

void expect_kernels_agree(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
                          const std::string& what) {
  Skinned expected(in);
  skin_reference(binding, pose, in, expected.view());
  for (const Simd simd : {Simd::other, Simd::avx2, Simd::avx512}) {
    limit_simd(simd);
    const Skinned found = skinned(binding, pose, in);
    limit_simd(Simd::avx512);
    expect_same_bits(expected, found, what + ", version " + std::to_string(static_cast<int>(simd)));
  }
}

// All methods, with a pose and with a palette that is not rigid.
void expect_kernels_agree(const Model& model, const SkinSurface& in, const std::string& what) {
  for (const SkinMethod method : kMethods) {
    const SkinBinding binding(model, method);
    SkinPose pose(binding);
    const std::string name = what + ", method " + std::to_string(static_cast<int>(method));
    pose.set(random_pose(kManyJoints, 3));
    expect_kernels_agree(binding, pose, in, name);
    pose.set_palette(random_palette(kManyJoints, 4, true));
    expect_kernels_agree(binding, pose, in, name + ", deforming");
  }
}

TEST(SkinKernels, GiveTheBitsOfTheReferenceTailsIncluded) {
  for (int influences = 1; influences <= Model::kMaxInfluences; ++influences) {
    for (std::size_t count = 0; count <= 67; count += influences == 4 ? 1 : 7) {
      const Model model = random_model(count, influences, kManyJoints, 7, true);
      expect_kernels_agree(model, skin_surface(model),
                           std::to_string(count) + " vertices, " + std::to_string(influences));
    }
  }
}

TEST(SkinKernels, GiveTheBitsOfTheReferenceWhereInfluencesDifferInNumber) {
  for (const std::size_t count : {300u, 2049u}) {
    const Model model = random_model(count, 8, kManyJoints, 8);
    expect_kernels_agree(model, skin_surface(model), std::to_string(count) + " vertices");
  }
}

TEST(SkinKernels, NormalsAndTangentsMayBeMissing) {
  const Model model = random_model(75, 4, kManyJoints, 9);
  SkinSurface in = skin_surface(model);
  in.tangents = {};
  expect_kernels_agree(model, in, "no tangents");
  in.normals = {};
  expect_kernels_agree(model, in, "positions alone");
  in.tangents = model.tangents;
  expect_kernels_agree(model, in, "no normals");
}

TEST(SkinKernels, GiveTheBitsOfTheReferenceForOddVectors) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const Vec3f& odd : {Vec3f(0, 0, 0), Vec3f(1e-20f, 0, 0), Vec3f(3e7f, -2e7f, 1),
                           Vec3f(1e20f, 0, 0), Vec3f(kNan, 0, 0), Vec3f(0, kInfinity, 0)}) {
    for (const std::size_t place : {0u, 15u, 16u, 34u}) {
      Model model = random_model(35, 4, kManyJoints, 10);
      model.normals[place] = odd;
      expect_kernels_agree(model, skin_surface(model), "an odd normal");
      model = random_model(35, 4, kManyJoints, 10);
      model.tangents[place].head<3>() = odd;
      expect_kernels_agree(model, skin_surface(model), "an odd tangent");
    }
  }
}

// Zero weights are left out of a binding; the plain function reads them all.
TEST(SkinKernels, PreparedInfluencesChangeNoBit) {
  const Model model = random_model(333, 8, kManyJoints, 11);
  const auto pose = random_pose(kManyJoints, 12);
  std::vector<SkinMatrix> palette(pose.size());
  make_palette(inverse_reference(model.skeleton), pose, palette);
  std::vector<Vec3f> positions(333), normals(333);
  linear_blend(palette, skin_vertices(model), {positions, normals});
  const Skinned prepared = skinned(model, SkinMethod::linear, pose);
  EXPECT_TRUE(same_bits(positions, prepared.positions));
  EXPECT_TRUE(same_bits(normals, prepared.normals));
}

TEST(SkinKernels, ThreadsDoNotChangeABit) {
  const Model model = random_model(10007, 6, kManyJoints, 13);
  for (const SkinMethod method : kMethods) {
    const SkinBinding binding(model, method);
    SkinPose pose(binding);
    pose.set(random_pose(kManyJoints, 14));
    expect_same_bits(skinned(binding, pose, skin_surface(model), 1),
                     skinned(binding, pose, skin_surface(model), 4), "4 threads");
  }
}

TEST(SkinKernels, AMeshWithoutVerticesIsNoTrouble) {
  const Model model = random_model(0, 4, 2, 15);
  for (const SkinMethod method : kMethods) {
    EXPECT_TRUE(skinned(model, method, random_pose(2, 16)).positions.empty());
  }
}

}  // namespace
}  // namespace krok::test
