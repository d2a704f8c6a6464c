#include "skin/dual_quaternion.h"

#include "math/dense_solve.h"

namespace krok {

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
