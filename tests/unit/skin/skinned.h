#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <random>
#include <vector>

#include "math/quaternion.h"
#include "skin/skin.h"

// Models and their skinned surfaces for the tests of lib/skin.

namespace krok::test {

constexpr SkinMethod kMethods[] = {SkinMethod::rigid, SkinMethod::linear,
                                   SkinMethod::dual_quaternion, SkinMethod::spherical};

// A surface that owns its vertices.
struct Skinned {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec4f> tangents;

  explicit Skinned(const SkinSurface& like)
      : positions(like.positions.size(), Vec3f::Constant(-7)),
        normals(like.normals.size(), Vec3f::Constant(-7)),
        tangents(like.tangents.size(), Vec4f::Constant(-7)) {}
  SkinnedSurface view() { return {positions, normals, tangents}; }
};

inline Skinned skinned(const SkinBinding& binding, const SkinPose& pose, const SkinSurface& in,
                       int jobs = 1) {
  Skinned out(in);
  skin(binding, pose, in, out.view(), jobs);
  return out;
}

// What a palette makes of a model.
inline Skinned skinned(const Model& model, SkinMethod method,
                       const std::vector<SkinMatrix>& palette) {
  const SkinBinding binding(model, method);
  SkinPose pose(binding);
  pose.set_palette(palette);
  return skinned(binding, pose, skin_surface(model));
}
inline Skinned skinned(const Model& model, SkinMethod method,
                       const std::vector<Transform>& joint_to_world) {
  const SkinBinding binding(model, method);
  SkinPose pose(binding);
  pose.set(joint_to_world);
  return skinned(binding, pose, skin_surface(model));
}

// Bit for bit, so that NaN and -0 count too.
template <class Vector>
testing::AssertionResult same_bits(const std::vector<Vector>& a, const std::vector<Vector>& b) {
  if (a.size() != b.size()) return testing::AssertionFailure() << a.size() << " and " << b.size();
  for (std::size_t v = 0; v < a.size(); ++v) {
    for (int i = 0; i < a[v].size(); ++i) {
      if (std::bit_cast<std::uint32_t>(a[v][i]) != std::bit_cast<std::uint32_t>(b[v][i])) {
        return testing::AssertionFailure()
               << "vertex " << v << ": " << a[v].transpose() << " and " << b[v].transpose();
      }
    }
  }
  return testing::AssertionSuccess();
}
inline void expect_same_bits(const Skinned& a, const Skinned& b, const std::string& what) {
  EXPECT_TRUE(same_bits(a.positions, b.positions)) << what;
  EXPECT_TRUE(same_bits(a.normals, b.normals)) << what;
  EXPECT_TRUE(same_bits(a.tangents, b.tangents)) << what;
}

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double unit() { return static_cast<double>(random_() % 20001) / 10000.0 - 1.0; }
  std::size_t below(std::size_t end) { return random_() % end; }
  Vec3 vector() { return Vec3(unit(), unit(), unit()); }
  Vec3 direction() { return (vector() + Vec3(0, 0, 1.8)).normalized(); }
  Transform transform() { return {vector(), from_rotation_vector(2.5 * vector())}; }

 private:
  std::mt19937 random_;
};

// Joints anywhere; each vertex on joints of its own, of which `most` count, fewer for some.
inline Model random_model(std::size_t vertices, int influences, int joints, unsigned seed,
                          bool all_count = false) {
  Random random(seed);
  Model model;
  for (int j = 0; j < joints; ++j) {
    model.skeleton.add("joint" + std::to_string(j), j - 1, random.transform());
  }
  model.influences_per_vertex = influences;
  for (std::size_t v = 0; v < vertices; ++v) {
    model.positions.push_back(random.vector().cast<float>());
    const Vec3 normal = random.direction();
    const Vec3 tangent = normal.cross(random.direction() + Vec3(3, 0, 0)).normalized();
    model.normals.push_back(normal.cast<float>());
    model.tangents.emplace_back(tangent.x(), tangent.y(), tangent.z(), v % 2 == 0 ? 1.0f : -1.0f);
    std::vector<double> weights;
    double sum = 0;
    // Neighbours have about as many, so that blocks differ.
    const auto used = all_count
                          ? static_cast<std::size_t>(influences)
                          : 1 + (v / 37 + random.below(2)) % static_cast<std::size_t>(influences);
    for (int k = 0; k < influences; ++k) {
      const bool counts = static_cast<std::size_t>(k) < used;
      weights.push_back(counts ? random.unit() + 1.001 : 0.0);
      sum += weights.back();
      model.influence_joints.push_back(
          counts ? static_cast<std::uint16_t>(random.below(static_cast<std::size_t>(joints))) : 0);
    }
    std::sort(weights.begin(), weights.end(), std::greater<>());
    for (const double weight : weights) {
      model.influence_weights.push_back(static_cast<float>(weight / sum));
    }
  }
  return model;
}

inline std::vector<Transform> random_pose(int joints, unsigned seed) {
  Random random(seed);
  std::vector<Transform> pose;
  for (int j = 0; j < joints; ++j) pose.push_back(random.transform());
  return pose;
}

inline SkinMatrix skin_matrix(const Mat4& matrix) {
  SkinMatrix result;
  Eigen::Map<Mat4f>(result.elements) = matrix.cast<float>();
  return result;
}

// Matrices that turn, scale and shear; with `mirrors`, every third mirrors too.
inline std::vector<SkinMatrix> random_palette(int joints, unsigned seed, bool mirrors = false) {
  Random random(seed);
  std::vector<SkinMatrix> palette;
  for (int j = 0; j < joints; ++j) {
    Mat4 deformation = Mat4::Identity();
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) deformation(r, c) += (r == c ? 0.4 : 0.25) * random.unit();
    }
    if (mirrors && j % 3 == 1) deformation.row(0) = -deformation.row(0);
    palette.push_back(skin_matrix(random.transform().matrix() * deformation));
  }
  return palette;
}

}  // namespace krok::test
