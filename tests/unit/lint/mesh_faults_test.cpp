// If these fail, krok-lint misses a fault that was put into a clean mesh, or blames a clean one.

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/index.h"
#include "lint/mesh_rules.h"

namespace krok::lint_test {
namespace {

using lint::Finding;
using lint::Rule;

// A tube of 20 rings of 12 vertices along Y, bound to a joint at each end with a blend between.
class LintMesh : public testing::Test {
 protected:
  static constexpr std::uint32_t kRings = 20, kAround = 12;

  LintMesh() {
    for (std::uint32_t ring = 0; ring < kRings; ++ring) {
      for (std::uint32_t k = 0; k < kAround; ++k) {
        const float angle = 6.2831853F * static_cast<float>(k) / kAround;
        const Vec3f out(std::cos(angle), 0, -std::sin(angle));
        positions_.push_back(out + Vec3f(0, static_cast<float>(ring), 0));
        normals_.push_back(out);
        const float upper = static_cast<float>(ring) / (kRings - 1);
        weights_.insert(weights_.end(), {1 - upper, upper});
        joints_.insert(joints_.end(), {0, 1});
        if (ring + 1 == kRings) continue;
        const std::uint32_t a = ring * kAround + k, b = ring * kAround + (k + 1) % kAround;
        triangles_.push_back({a, b, a + kAround});
        triangles_.push_back({b, b + kAround, a + kAround});
      }
    }
    rests_[1](1, 3) = kRings, binds_[1](1, 3) = -double{kRings};
  }
  std::vector<Finding> faults() const {
    lint::MeshView view;
    view.name = "tube";
    view.positions = positions_, view.normals = normals_, view.triangles = triangles_;
    view.joint_names = names_, view.rests = rests_, view.inverse_binds = binds_;
    view.influences_per_vertex = 2;
    view.influence_joints = joints_, view.influence_weights = weights_;
    return lint::lint_mesh(view, lint::Settings());
  }
  // That the mesh has this fault and no other.
  void expect(Rule rule, const std::string& kind) const {
    const auto found = faults();
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].rule, rule);
    EXPECT_EQ(found[0].kind, kind);
    EXPECT_EQ(found[0].mesh, "tube");
  }

  std::vector<Vec3f> positions_, normals_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::string> names_ = {"Root", "Tip"};
  std::vector<Mat4> rests_ = std::vector<Mat4>(2, Mat4::Identity()),
                    binds_ = std::vector<Mat4>(2, Mat4::Identity());
  std::vector<std::uint16_t> joints_;
  std::vector<float> weights_;
};

// Posed joints, a scale above the whole armature and joints that hide what hangs on them are usual.
TEST_F(LintMesh, ACleanMeshHasNoFault) {
  EXPECT_TRUE(faults().empty());
  rests_[1].topLeftCorner<3, 3>() = Eigen::AngleAxisd(0.8, Vec3::UnitX()).toRotationMatrix();
  EXPECT_TRUE(faults().empty());
  for (Mat4& rest : rests_) rest.topRows<3>() *= 0.01;
  EXPECT_TRUE(faults().empty());
  rests_[1].topLeftCorner<3, 3>() *= 1e-3;
  EXPECT_TRUE(faults().empty());
}

TEST_F(LintMesh, TrianglesWithoutAreaAndWithAVertexTwice) {
  for (std::uint32_t t = 0; t < 3; ++t) triangles_.push_back({t, t, t + 1});
  const std::uint32_t same = static_cast<std::uint32_t>(positions_.size());
  positions_.push_back(positions_[0]);
  normals_.push_back(normals_[0]);
  joints_.insert(joints_.end(), {0, 1});
  weights_.insert(weights_.end(), {1, 0});
  triangles_.push_back({0, same, 1});
  expect(Rule::degenerate_triangle, "");
  EXPECT_EQ(faults()[0].detail.substr(0, 40), "3 with a vertex twice, 1 without area, f");
}

// Seams double vertices: the neighbours across them count as well.
TEST_F(LintMesh, TrianglesThatFaceTheOtherSide) {
  const std::size_t count = positions_.size();
  for (std::size_t v = 0; v < count; ++v) {
    positions_.push_back(positions_[v]);
    normals_.push_back(-normals_[v]);
    joints_.insert(joints_.end(), {0, 1});
    weights_.insert(weights_.end(), {weights_[2 * v], weights_[2 * v + 1]});
  }
  for (std::size_t t = 100; t < 108; ++t) {
    for (std::uint32_t& corner : triangles_[t]) corner += static_cast<std::uint32_t>(count);
    std::swap(triangles_[t][1], triangles_[t][2]);
  }
  expect(Rule::triangle_winding, "");
}

TEST_F(LintMesh, NormalsThatAreZeroOrOpposite) {
  normals_[7].setZero();
  expect(Rule::vertex_normal, "zero");
  normals_[7] = normals_[7 + kAround];
  for (std::size_t v = 30; v < 35; ++v) normals_[v] = -normals_[v];
  expect(Rule::vertex_normal, "opposite");
}

TEST_F(LintMesh, BindPosesThatCannotBe) {
  const Mat4 bind = binds_[1], rest = rests_[1];
  binds_[1].row(1).setZero();
  expect(Rule::bind_pose, "singular");
  binds_[1] = bind;
  rests_[1].topLeftCorner<3, 3>() *= 10;
  EXPECT_EQ(faults().at(0).kind, "scale");
  rests_[1] = rest;
  // One vertex on a joint whose matrix is that of another place.
  names_.emplace_back("Lost");
  rests_.push_back(Mat4::Identity());
  binds_.push_back(Mat4::Identity());
  rests_[2](0, 3) = 100;
  joints_[40] = 2;
  expect(Rule::bind_pose, "torn");
}

}  // namespace
}  // namespace krok::lint_test
