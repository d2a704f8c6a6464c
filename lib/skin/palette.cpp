#include "skin/palette.h"

#include <cassert>

#include "math/dense_solve.h"

namespace krok {

std::vector<Transform> inverse_reference(const Skeleton& skeleton) {
  std::vector<Transform> inverses;
  inverses.reserve(skeleton.reference.size());
  for (const Transform& joint_to_world : skeleton.reference) {
    inverses.push_back(joint_to_world.inverse());
  }
  return inverses;
}

void make_palette(std::span<const Transform> reference_to_joint,
                  std::span<const Transform> joint_to_world, std::span<SkinMatrix> palette) {
  assert(reference_to_joint.size() == palette.size());
  assert(joint_to_world.size() == palette.size());
  for (std::size_t j = 0; j < palette.size(); ++j) {
    const Mat4f matrix = (joint_to_world[j] * reference_to_joint[j]).matrix().cast<float>();
    Eigen::Map<Mat4f>(palette[j].elements) = matrix;
  }
}

SkinMatrix skin_matrix(const Transform& reference_to_joint, const Transform& rigid,
                       const Stretch& stretch) {
  SkinMatrix result;
  const Mat4 whole = joint_to_world(rigid, stretch) * reference_to_joint.matrix();
  Eigen::Map<Mat4f>(result.elements) = whole.cast<float>();
  return result;
}

namespace {

Mat4 matrix_of(const SkinMatrix& matrix) {
  return Eigen::Map<const Mat4f>(matrix.elements).cast<double>();
}

// The rotation nearest to `a`.
Mat3 rotation_of(const Mat3& a) {
  if (!a.allFinite()) return Mat3::Identity();
  return nearest_rotation(a);
}

}  // namespace

DualQuaternion dual_quaternion(const Transform& transform) {
  const Quat& q = transform.orientation;
  const Vec3& t = transform.position;
  const Quat dual = Quat(0, 0.5 * t.x(), 0.5 * t.y(), 0.5 * t.z()) * q;
  DualQuaternion result;
  for (int i = 0; i < 4; ++i) {
    result.components[i] = static_cast<float>(q.coeffs()[i]);
    result.components[4 + i] = static_cast<float>(dual.coeffs()[i]);
  }
  return result;
}

bool is_rigid(const SkinMatrix& matrix) {
  const Mat3 a = matrix_of(matrix).topLeftCorner<3, 3>();
  const Mat3 difference = a.transpose() * a - Mat3::Identity();
  return difference.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e-5 && a.determinant() > 0;
}

SplitMatrix split(const SkinMatrix& matrix, const Vec3& centre) {
  const Mat4 whole = matrix_of(matrix);
  const Mat3 a = whole.topLeftCorner<3, 3>();
  const Vec3 moved = a * centre + whole.topRightCorner<3, 1>();
  const Mat3 rotation = rotation_of(a);
  Mat4 deformation = Mat4::Identity();
  if (!is_rigid(matrix)) {
    const Mat3 s = rotation.transpose() * a;
    deformation.topLeftCorner<3, 3>() = s;
    deformation.topRightCorner<3, 1>() = centre - s * centre;
  }
  SplitMatrix result;
  const Quat turn(rotation);
  result.motion = dual_quaternion({moved - turn * centre, turn.normalized()});
  Eigen::Map<Mat4f>(result.deformation.elements) = deformation.cast<float>();
  return result;
}

}  // namespace krok
