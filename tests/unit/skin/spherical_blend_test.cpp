// Would fail if spherical blend skinning moved a vertex elsewhere than the definition of Kavan and
// Zara (I3D 2005) does, whose reference is here: for each vertex alone, in double precision, the
// rotation centre by a pseudo-inverse.

#include <Eigen/SVD>
#include <set>

#include "skinned.h"

namespace krok::test {
namespace {

// Motions of the reference pose, joint by joint.
std::vector<Transform> motions(const Model& model, const std::vector<Transform>& pose) {
  std::vector<Transform> result;
  for (std::size_t j = 0; j < pose.size(); ++j) {
    result.push_back(pose[j] * model.skeleton.reference[j].inverse());
  }
  return result;
}

Vec3 reference_place(const Model& model, const std::vector<Transform>& motion, std::size_t v) {
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  std::set<int> joints;
  for (std::size_t k = 0; k < places; ++k) {
    if (model.influence_weights[v * places + k] > 0) {
      joints.insert(model.influence_joints[v * places + k]);
    }
  }
  Vec3 start = Vec3::Zero();
  int later = 0;
  for (const int j : joints) {
    if (j == *joints.begin() && joints.size() > 1) continue;
    start += model.skeleton.reference[static_cast<std::size_t>(j)].position;
    ++later;
  }
  start /= later;
  Vec3 centre = start;
  if (joints.size() > 1) {
    const auto rows = static_cast<Eigen::Index>(3 * joints.size() * (joints.size() - 1) / 2);
    Eigen::MatrixXd d(rows, 3);
    Eigen::VectorXd e(rows);
    Eigen::Index row = 0;
    for (const int a : joints) {
      for (const int b : joints) {
        if (b >= a) continue;
        const Transform& one = motion[static_cast<std::size_t>(a)];
        const Transform& other = motion[static_cast<std::size_t>(b)];
        d.middleRows<3>(row) =
            one.orientation.toRotationMatrix() - other.orientation.toRotationMatrix();
        e.segment<3>(row) = other * start - one * start;
        row += 3;
      }
    }
    Eigen::JacobiSVD<Eigen::MatrixXd> svd(d, Eigen::ComputeThinU | Eigen::ComputeThinV);
    svd.setThreshold(1e-6);
    centre += svd.solve(e);
  }
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  Vec3 moved = Vec3::Zero();
  const Quat first = motion[static_cast<std::size_t>(*joints.begin())].orientation;
  for (std::size_t k = 0; k < places; ++k) {
    const double weight = model.influence_weights[v * places + k];
    if (!(weight > 0)) continue;
    const Transform& by = motion[model.influence_joints[v * places + k]];
    sum += weight * in_hemisphere_of(first, by.orientation).coeffs();
    moved += weight * (by * centre);
  }
  const Quat turn(Eigen::Vector4d(sum.normalized()));
  return turn * (model.positions[v].cast<double>() - centre) + moved;
}

TEST(SphericalBlend, IsWhatTheReferenceSays) {
  constexpr int kJoints = 9;
  double largest = 0;
  for (const int influences : {1, 2, 3, 4, 8}) {
    const Model model = random_model(400, influences, kJoints, 31);
    const auto pose = random_pose(kJoints, 32);
    const auto motion = motions(model, pose);
    const Skinned found = skinned(model, SkinMethod::spherical, pose);
    for (std::size_t v = 0; v < model.positions.size(); ++v) {
      const double apart =
          (found.positions[v].cast<double>() - reference_place(model, motion, v)).norm();
      largest = std::max(largest, apart);
    }
  }
  EXPECT_LT(largest, 5e-5);  // metres, of a mesh of 2 m; rotations are floats
}

// Two bones: all vertices keep their distance from the joint, as on a sphere.
TEST(SphericalBlend, OfTwoBonesKeepsTheDistanceFromTheirJoint) {
  Model model = random_model(300, 2, 2, 33);
  const Vec3 joint = model.skeleton.reference[1].position;
  for (const Vec3& turn : {Vec3(0, 0, 2), Vec3(2.6, 0, 0), Vec3(0.5, -1, 0.3), Vec3(1e-4, 0, 0)}) {
    auto pose = model.skeleton.reference;
    pose[1].orientation = from_rotation_vector(turn) * pose[1].orientation;
    const Skinned found = skinned(model, SkinMethod::spherical, pose);
    for (std::size_t v = 0; v < model.positions.size(); ++v) {
      EXPECT_NEAR((found.positions[v].cast<double>() - joint).norm(),
                  (model.positions[v].cast<double>() - joint).norm(), 2e-6);
    }
  }
}

TEST(SphericalBlend, TurnsWithTheWholeBody) {
  const Model model = random_model(200, 4, 6, 34);
  auto pose = random_pose(6, 35);
  const Skinned before = skinned(model, SkinMethod::spherical, pose);
  const Transform place{Vec3(2, -3, 1), from_rotation_vector(Vec3(0.4, 2, -1))};
  for (Transform& joint : pose) joint = place * joint;
  const Skinned after = skinned(model, SkinMethod::spherical, pose);
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    const Vec3 expected = place * before.positions[v].cast<double>();
    EXPECT_LT((after.positions[v].cast<double>() - expected).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace krok::test
