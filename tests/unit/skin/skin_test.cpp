// Would fail if a vertex, a normal or a tangent landed elsewhere than the method's formula puts it,
// or if odd weights and palettes did other things than skin.h says.

#include <limits>

#include "skin/palette.h"
#include "skinned.h"

namespace krok::test {
namespace {

constexpr int kFewJoints = 12;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Mat4 palette_matrix(const Model& model, const std::vector<Transform>& pose, std::size_t joint) {
  return (pose[joint] * model.skeleton.reference[joint].inverse()).matrix();
}

// The map of one vertex, straight from the formulas, in doubles.
Mat4 by_formula(const Model& model, const std::vector<Transform>& pose, SkinMethod method,
                std::size_t v) {
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  const std::uint16_t* joints = &model.influence_joints[v * places];
  const float* weights = &model.influence_weights[v * places];
  if (method == SkinMethod::rigid) return palette_matrix(model, pose, joints[0]);
  Mat4 matrix = Mat4::Zero();
  Vec4 real = Vec4::Zero(), dual = Vec4::Zero(), first = Vec4::Zero();
  for (std::size_t k = 0; k < places; ++k) {
    matrix += double{weights[k]} * palette_matrix(model, pose, joints[k]);
    const Transform moved = pose[joints[k]] * model.skeleton.reference[joints[k]].inverse();
    const Quat translation(0, moved.position.x(), moved.position.y(), moved.position.z());
    const Vec4 q = moved.orientation.coeffs();
    if (k == 0) first = q;
    const double sign = q.dot(first) < 0 ? -1 : 1;
    real += sign * weights[k] * q;
    dual += sign * weights[k] * 0.5 * (translation * moved.orientation).coeffs();
  }
  if (method == SkinMethod::linear) return matrix;
  const double length = real.norm();
  const Quat turn(Vec4(real / length));
  Transform result;
  result.orientation = turn;
  result.position = 2 * (Quat(Vec4(dual / length)) * turn.conjugate()).vec();
  return result.matrix();
}

TEST(Skin, AgreesWithTheFormulasInDoubles) {
  for (int influences = 1; influences <= Model::kMaxInfluences; ++influences) {
    const Model model = random_model(200, influences, kFewJoints, 21);
    const auto pose = random_pose(kFewJoints, 22);
    for (const SkinMethod method : kMethods) {
      if (method == SkinMethod::spherical) continue;  // spherical_blend_test.cpp
      const Skinned out = skinned(model, method, pose);
      for (std::size_t v = 0; v < model.positions.size(); ++v) {
        const Mat4 map = by_formula(model, pose, method, v);
        const Vec3 position = (map * model.positions[v].cast<double>().homogeneous()).head<3>();
        ASSERT_LT((out.positions[v].cast<double>() - position).norm(), 4e-6) << v;
        // Sums of matrices that nearly cancel leave little of a normal's digits.
        const Mat3 turn = map.topLeftCorner<3, 3>();
        const Vec3 normal = turn * model.normals[v].cast<double>();
        const Vec3 tangent = turn * model.tangents[v].head<3>().cast<double>();
        ASSERT_LT((out.normals[v].cast<double>() - normal.normalized()).norm(),
                  1e-6 / normal.norm());
        ASSERT_LT((out.tangents[v].head<3>().cast<double>() - tangent.normalized()).norm(),
                  1e-6 / tangent.norm());
        ASSERT_EQ(out.tangents[v].w(), model.tangents[v].w());
      }
    }
  }
}

TEST(Skin, RigidMotionOfTheSkeletonMovesEveryVertexRigidly) {
  const Model model = random_model(100, 4, kFewJoints, 23);
  const Transform move{Vec3(3, -2, 5), from_rotation_vector(Vec3(0.4, -2.0, 0.9))};
  std::vector<Transform> pose;
  for (const Transform& joint : model.skeleton.reference) pose.push_back(move * joint);
  for (const SkinMethod method : kMethods) {
    const Skinned out = skinned(model, method, pose);
    for (std::size_t v = 0; v < model.positions.size(); ++v) {
      const Vec3 expected = move * model.positions[v].cast<double>();
      const Vec3 normal = move.orientation * model.normals[v].cast<double>();
      const Vec3 tangent = move.orientation * model.tangents[v].head<3>().cast<double>();
      EXPECT_LT((out.positions[v].cast<double>() - expected).norm(), 3e-6);
      EXPECT_LT((out.normals[v].cast<double>() - normal).norm(), 1e-6);
      EXPECT_LT((out.tangents[v].head<3>().cast<double>() - tangent).norm(), 1e-6);
    }
  }
}

// Weights whose sums are 1 exactly, whatever the order: eighths.
void make_weights_exact(Model& model) {
  const auto places = static_cast<std::size_t>(model.influences_per_vertex);
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    for (std::size_t k = 0; k < places; ++k) {
      model.influence_weights[v * places + k] =
          k == 0 ? 1 - 0.125f * static_cast<float>(places - 1) : 0.125f;
    }
  }
}

TEST(Skin, TheIdentityGivesTheReferenceMeshToTheBit) {
  const std::vector<SkinMatrix> palette(kFewJoints, skin_matrix(Mat4::Identity()));
  for (int influences = 1; influences <= Model::kMaxInfluences; ++influences) {
    const Model uneven = random_model(99, influences, kFewJoints, 24);
    Model exact = uneven;
    make_weights_exact(exact);
    for (const SkinMethod method : kMethods) {
      const Model& model = method == SkinMethod::linear ? exact : uneven;
      EXPECT_TRUE(same_bits(skinned(model, method, palette).positions, model.positions))
          << influences << " influences, method " << static_cast<int>(method);
    }
  }
}

TEST(Skin, ANewPoseIsTheReferencePose) {
  const Model model = random_model(99, 4, kFewJoints, 25);
  for (const SkinMethod method : kMethods) {
    const SkinBinding binding(model, method);
    const Skinned out = skinned(binding, SkinPose(binding), skin_surface(model));
    for (std::size_t v = 0; v < model.positions.size(); ++v) {
      EXPECT_LT((out.positions[v] - model.positions[v]).norm(), 1e-6f);
      EXPECT_LT((out.normals[v] - model.normals[v]).norm(), 1e-6f);
    }
  }
}

TEST(Skin, WithOneInfluenceAllMethodsAgree) {
  const Model model = random_model(200, 1, kFewJoints, 26);
  const auto pose = random_pose(kFewJoints, 27);
  const auto deforming = random_palette(kFewJoints, 28, true);
  const auto expect_alike = [&](const auto& posed) {
    const Skinned linear = skinned(model, SkinMethod::linear, posed);
    expect_same_bits(linear, skinned(model, SkinMethod::rigid, posed), "rigid");
    const Skinned dual = skinned(model, SkinMethod::dual_quaternion, posed);
    for (std::size_t v = 0; v < model.positions.size(); ++v) {
      EXPECT_LT((linear.positions[v] - dual.positions[v]).norm(), 4e-6f);
      EXPECT_LT((linear.normals[v] - dual.normals[v]).norm(), 4e-6f);
      EXPECT_LT((linear.tangents[v] - dual.tangents[v]).norm(), 4e-6f);
    }
  };
  expect_alike(pose);
  expect_alike(deforming);
}

TEST(Skin, RigidFollowsTheStrongestJoint) {
  Model model = random_model(1, 3, 3, 29);
  model.influence_joints = {0, 1, 2};
  model.influence_weights = {0.2f, 0.5f, 0.3f};  // not in order
  const auto pose = random_pose(3, 30);
  const Vec3 expected =
      pose[1] * (model.skeleton.reference[1].inverse() * model.positions[0].cast<double>());
  const Skinned out = skinned(model, SkinMethod::rigid, pose);
  EXPECT_LT((out.positions[0].cast<double>() - expected).norm(), 2e-6);
}

// q and -q are one rotation: which of them a file has must not show.
TEST(Skin, TheSignOfAQuaternionDoesNotMatter) {
  const Model model = random_model(150, 4, kFewJoints, 31);
  const auto pose = random_pose(kFewJoints, 32);
  auto turned = pose;
  for (std::size_t j = 0; j < turned.size(); j += 2) {
    turned[j].orientation.coeffs() = -turned[j].orientation.coeffs();
  }
  expect_same_bits(skinned(model, SkinMethod::dual_quaternion, pose),
                   skinned(model, SkinMethod::dual_quaternion, turned), "signs");
}

// Three points of each small triangle share their weights, so that the surface's differential is
// that of the blended map.
Model small_triangles(unsigned seed, double size) {
  Model model = random_model(60, 4, kFewJoints, seed);
  Model result = model;
  for (auto* list : {&result.positions, &result.normals}) list->clear();
  result.tangents.clear();
  result.influence_joints.clear();
  result.influence_weights.clear();
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    const Vec3f normal = model.normals[v];
    const Vec3f tangent = model.tangents[v].head<3>();
    const Vec3f bitangent = model.tangents[v].w() * normal.cross(tangent);
    const auto step = static_cast<float>(size);
    for (const Vec3f& offset : {Vec3f(0, 0, 0), Vec3f(step * tangent), Vec3f(step * bitangent)}) {
      result.positions.push_back(model.positions[v] + offset);
      result.normals.push_back(normal);
      result.tangents.push_back(model.tangents[v]);
      for (std::size_t k = 4 * v; k < 4 * v + 4; ++k) {
        result.influence_joints.push_back(model.influence_joints[k]);
        result.influence_weights.push_back(model.influence_weights[k]);
      }
    }
  }
  return result;
}

TEST(Skin, NormalsArePerpendicularToASurfaceThatDeforms) {
  const Model model = small_triangles(33, 0.05);
  const auto palette = random_palette(kFewJoints, 34);
  for (const SkinMethod method : kMethods) {
    const Skinned out = skinned(model, method, palette);
    int checked = 0;
    for (std::size_t v = 0; v < model.positions.size(); v += 3) {
      const Vec3f along = (out.positions[v + 1] - out.positions[v]) / 0.05f;
      const Vec3f across = (out.positions[v + 2] - out.positions[v]) / 0.05f;
      const Vec3f area = along.cross(across);
      if (area.norm() < 0.05f) continue;  // folded to nothing, no normal to speak of
      ++checked;
      const float error = 1e-5f / area.norm();
      // Which side is out does not follow from the two edges where the blended map mirrors.
      const float handed = model.tangents[v].w();
      EXPECT_LT(std::abs(out.normals[v].dot(along)), error);
      EXPECT_LT(std::abs(out.normals[v].dot(across)), error);
      const Vec3f tangent = out.tangents[v].head<3>();
      EXPECT_LT((tangent - along.normalized()).norm(), error);
      // The third edge as shaders make it, w (n x t), lies on the side of the moved one.
      EXPECT_GT(out.tangents[v].w() * out.normals[v].cross(tangent).dot(across), 0);
      EXPECT_EQ(std::abs(out.tangents[v].w()), std::abs(handed));
    }
    EXPECT_GT(checked, 40) << static_cast<int>(method);
  }
}

// What points out of a body points out of its mirror image.
TEST(Skin, NormalsStayOutsideWhereAPaletteMirrors) {
  Model model = random_model(1, 1, 1, 35);
  model.positions = {{1, 0, 0}};
  model.normals = {{1, 0, 0}};
  model.tangents = {{0, 1, 0, 1}};
  model.skeleton.reference[0] = {};
  Mat4 mirror = Mat4::Identity();
  mirror(0, 0) = -2;
  for (const SkinMethod method : kMethods) {
    const Skinned out = skinned(model, method, {skin_matrix(mirror)});
    EXPECT_LT((out.positions[0] - Vec3f(-2, 0, 0)).norm(), 1e-6f);
    EXPECT_LT((out.normals[0] - Vec3f(-1, 0, 0)).norm(), 1e-6f);
    EXPECT_LT((out.tangents[0] - Vec4f(0, 1, 0, -1)).norm(), 1e-6f);
  }
}

// Deformations are blended about the joints, not about the world's origin.
TEST(Skin, DualQuaternionsScaleAboutTheJoint) {
  Model model = random_model(1, 2, 2, 36);
  const Vec3 joint(10, 0, 0);
  for (auto& place : model.skeleton.reference) place = {joint, Quat::Identity()};
  model.positions = {{10, 1, 0}};
  model.influence_joints = {0, 1};
  model.influence_weights = {0.5f, 0.5f};
  const auto about_joint = [&](const Mat3& a) {
    Mat4 matrix = Mat4::Identity();
    matrix.topLeftCorner<3, 3>() = a;
    matrix.topRightCorner<3, 1>() = joint - a * joint;
    return skin_matrix(matrix);
  };
  const Mat3 quarter = from_rotation_vector(Vec3(0, 0, kPi / 2)).toRotationMatrix();
  const Skinned out = skinned(model, SkinMethod::dual_quaternion,
                              {about_joint(Mat3::Identity()), about_joint(3 * quarter)});
  const double c = std::sqrt(0.5);  // an eighth of a turn, twice the size
  EXPECT_LT((out.positions[0].cast<double>() - Vec3(10 - 2 * c, 2 * c, 0)).norm(), 4e-6);
}

TEST(Skin, WeightsThatDoNotSumToOne) {
  Model model = random_model(64, 3, kFewJoints, 37, true);
  const auto pose = random_pose(kFewJoints, 38);
  std::vector<Skinned> before;
  for (const SkinMethod method : kMethods) before.push_back(skinned(model, method, pose));
  for (float& weight : model.influence_weights) weight *= 0.5f;
  // Linear blend takes them as they are; the others do not notice.
  expect_same_bits(before[0], skinned(model, kMethods[0], pose), "rigid");
  const Skinned linear = skinned(model, kMethods[1], pose);
  const Skinned dual = skinned(model, kMethods[2], pose);
  for (std::size_t v = 0; v < model.positions.size(); ++v) {
    EXPECT_EQ(linear.positions[v], Vec3f(0.5f * before[1].positions[v]));
    EXPECT_LT((dual.positions[v] - before[2].positions[v]).norm(), 2e-6f);
  }
}

TEST(Skin, VerticesWithoutWeightsFollowTheirFirstJoint) {
  for (const float none : {0.0f, -1.0f, kNan}) {
    Model model = random_model(40, 4, kFewJoints, 39);
    for (std::size_t k = 0; k < 4; ++k) model.influence_weights[4 * 17 + k] = none;
    model.influence_joints[4 * 17] = 5;
    const auto pose = random_pose(kFewJoints, 40);
    const Vec3 expected =
        pose[5] * (model.skeleton.reference[5].inverse() * model.positions[17].cast<double>());
    for (const SkinMethod method : kMethods) {
      const Skinned out = skinned(model, method, pose);
      EXPECT_LT((out.positions[17].cast<double>() - expected).norm(), 3e-6);
    }
  }
}

TEST(Skin, NanInAPaletteReachesItsVerticesAlone) {
  const Model model = random_model(100, 4, kFewJoints, 41);
  auto palette = random_palette(kFewJoints, 42);
  std::vector<Skinned> before;
  for (const SkinMethod method : kMethods) before.push_back(skinned(model, method, palette));
  constexpr std::uint16_t kBad = 3;
  for (float& element : palette[kBad].elements) element = kNan;
  for (std::size_t m = 0; m < 3; ++m) {
    const Skinned out = skinned(model, kMethods[m], palette);
    int moved = 0;
    for (std::size_t v = 0; v < model.positions.size(); ++v) {
      bool follows = false;
      for (std::size_t k = 0; k < (m == 0 ? 1 : 4); ++k) {
        follows |=
            model.influence_weights[4 * v + k] > 0 && model.influence_joints[4 * v + k] == kBad;
      }
      moved += follows ? 1 : 0;
      if (follows) {
        EXPECT_TRUE(out.positions[v].hasNaN());
      } else {
        EXPECT_EQ(out.positions[v], before[m].positions[v]);
      }
      EXPECT_NEAR(out.normals[v].norm(), 1, 1e-6f);
      EXPECT_NEAR(out.tangents[v].head<3>().norm(), 1, 1e-6f);
    }
    EXPECT_GT(moved, 3);
  }
}

// Half a turn and none, half each: the sum of the matrices flattens the y axis, that of the dual
// quaternions is a quarter of a turn.
TEST(Skin, OppositeInfluences) {
  Model model = random_model(1, 2, 2, 43);
  for (auto& place : model.skeleton.reference) place = {};
  model.positions = {{0, 1, 0}};
  model.normals = {{0, 2, 0}};
  model.tangents = {{0, 0, 1, 1}};
  model.influence_joints = {1, 0};
  model.influence_weights = {0.5f, 0.5f};
  std::vector<Transform> pose(2);
  pose[1].orientation = Quat(0, 1, 0, 0);
  const Skinned linear = skinned(model, SkinMethod::linear, pose);
  EXPECT_EQ(linear.positions[0], Vec3f(0, 0, 0));
  EXPECT_LT((linear.normals[0] - Vec3f(0, -1, 0)).norm(), 1e-6f);  // by the first joint alone
  const Skinned dual = skinned(model, SkinMethod::dual_quaternion, pose);
  EXPECT_LT((dual.positions[0].cwiseAbs() - Vec3f(0, 0, 1)).norm(), 1e-6f);
  EXPECT_LT((dual.normals[0] - dual.positions[0]).norm(), 1e-6f);
}

TEST(Skin, VectorsWithoutLengthGetADirection) {
  Model model = random_model(20, 2, kFewJoints, 44);
  model.normals[7].setZero();
  model.normals[8] = {kNan, 0, 0};
  model.tangents[9] = {0, 0, 0, -1};
  for (const SkinMethod method : kMethods) {
    const Skinned out = skinned(model, method, random_pose(kFewJoints, 45));
    EXPECT_EQ(out.normals[7], Vec3f::UnitY());
    EXPECT_EQ(out.normals[8], Vec3f::UnitY());
    EXPECT_EQ(out.tangents[9], Vec4f(1, 0, 0, -1));
  }
}

}  // namespace
}  // namespace krok::test
