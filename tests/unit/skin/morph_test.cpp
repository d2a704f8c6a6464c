// Would fail if a vertex of a morphed mesh stood elsewhere than v + sum_i w_i (p_i - v), if targets
// came out otherwise than they stand in the set, or if the skeleton moved what is not yet morphed.

#include "skin/morph.h"

#include <limits>

#include "skinned.h"

namespace krok::test {
namespace {

constexpr std::size_t kMorphVertices = 700;

MorphSet random_morphs(int targets, unsigned seed) {
  Random random(seed);
  MorphSet morphs;
  morphs.vertex_count = static_cast<int>(kMorphVertices);
  for (int i = 0; i < targets; ++i) {
    morphs.names.push_back("target" + std::to_string(i));
    for (std::size_t v = 0; v < kMorphVertices; ++v) {
      morphs.positions.push_back(random.vector().cast<float>());
      morphs.normals.push_back(random.direction().cast<float>());
    }
  }
  return morphs;
}

Skinned morphed(const MorphSet& morphs, const std::vector<float>& weights, const Model& model,
                int jobs = 1) {
  Skinned out(SkinSurface{model.positions, model.normals, {}});
  apply_morphs(morphs, weights, {model.positions, model.normals}, {out.positions, out.normals},
               jobs);
  return out;
}

TEST(Morph, AgreesWithTheFormula) {
  const Model model = random_model(kMorphVertices, 1, 2, 51);
  const MorphSet morphs = random_morphs(3, 52);
  const std::vector<float> weights = {0.25f, -0.5f, 1.5f};
  const Skinned out = morphed(morphs, weights, model);
  for (std::size_t v = 0; v < kMorphVertices; ++v) {
    Vec3 position = model.positions[v].cast<double>(), normal = model.normals[v].cast<double>();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t place = i * kMorphVertices + v;
      position += weights[i] * (morphs.positions[place] - model.positions[v]).cast<double>();
      normal += weights[i] * (morphs.normals[place] - model.normals[v]).cast<double>();
    }
    EXPECT_LT((out.positions[v].cast<double>() - position).norm(), 5e-7);
    EXPECT_LT((out.normals[v].cast<double>() - normal.normalized()).norm(), 5e-7 / normal.norm());
  }
}

TEST(Morph, AWholeTargetComesOutAsItStands) {
  const Model model = random_model(kMorphVertices, 1, 2, 53);
  MorphSet morphs = random_morphs(2, 54);
  morphs.positions[5].x() = std::numeric_limits<float>::quiet_NaN();  // has weight 0, is not read
  const Skinned out = morphed(morphs, {0, 1}, model);
  const auto target = morphs.target_positions(1);
  EXPECT_TRUE(same_bits(out.positions, {target.begin(), target.end()}));
}

TEST(Morph, WithoutWeightsNothingMoves) {
  Model model = random_model(kMorphVertices, 1, 2, 55);
  model.normals[3] *= 2;  // as they are, whatever that is
  const MorphSet morphs = random_morphs(2, 56);
  const Skinned out = morphed(morphs, {0, -0.0f}, model);
  EXPECT_TRUE(same_bits(out.positions, model.positions));
  EXPECT_TRUE(same_bits(out.normals, model.normals));
  const Skinned none = morphed(MorphSet{}, {}, model);
  EXPECT_TRUE(same_bits(none.positions, model.positions));
}

TEST(Morph, NormalsWithoutLengthStayTheMeshs) {
  const Model model = random_model(kMorphVertices, 1, 2, 57);
  MorphSet morphs = random_morphs(1, 58);
  morphs.normals[4] = -model.normals[4];
  morphs.normals[5].y() = std::numeric_limits<float>::infinity();
  const Skinned out = morphed(morphs, {0.5f}, model);
  EXPECT_EQ(out.normals[4], model.normals[4]);
  EXPECT_EQ(out.normals[5], model.normals[5]);
  EXPECT_NEAR(out.normals[6].norm(), 1, 1e-6f);
}

TEST(Morph, TargetsWithoutNormalsLeaveTheMeshs) {
  const Model model = random_model(kMorphVertices, 1, 2, 59);
  MorphSet morphs = random_morphs(2, 60);
  const Skinned with = morphed(morphs, {0.5f, 0.5f}, model);
  morphs.normals.clear();
  const Skinned without = morphed(morphs, {0.5f, 0.5f}, model);
  EXPECT_TRUE(same_bits(with.positions, without.positions));
  EXPECT_TRUE(same_bits(without.normals, model.normals));
}

TEST(Morph, ThreadsDoNotChangeABit) {
  const Model model = random_model(kMorphVertices, 1, 2, 61);
  const MorphSet morphs = random_morphs(5, 62);
  const std::vector<float> weights = {0.1f, 0.2f, 0.3f, 0.4f, 0.5f};
  expect_same_bits(morphed(morphs, weights, model, 1), morphed(morphs, weights, model, 4), "jobs");
}

// M (v + w (p - v)), not M v + w (p - v).
TEST(Morph, ComesBeforeTheSkeleton) {
  const Model model = random_model(kMorphVertices, 1, 2, 63);
  const MorphSet morphs = random_morphs(1, 64);
  const Skinned shape = morphed(morphs, {0.75f}, model);
  const auto pose = random_pose(2, 65);
  for (const SkinMethod method : kMethods) {
    const SkinBinding binding(model, method);
    SkinPose posed(binding);
    posed.set(pose);
    const Skinned out = skinned(binding, posed, {shape.positions, shape.normals, {}});
    for (std::size_t v = 0; v < kMorphVertices; ++v) {
      const std::size_t j = model.influence_joints[v];
      const Vec3 expected =
          pose[j] * (model.skeleton.reference[j].inverse() * shape.positions[v].cast<double>());
      ASSERT_LT((out.positions[v].cast<double>() - expected).norm(), 4e-6);
    }
  }
}

}  // namespace
}  // namespace krok::test
