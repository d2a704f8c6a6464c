// Would fail if a skeleton that is not in the pose of its mesh went unnoticed, or if a good one, of
// a mesh with holes, of sheets or with its faces inside out, were called bad.

#include "skin/bind.h"

#include <gtest/gtest.h>

#include "math/quaternion.h"
#include "unit/correctives/bent_tube.h"

namespace krok::test {
namespace {

void bend(Model& tube, double degrees) {
  tube.skeleton.reference = bent(tube, Vec3(0, 0, degrees * kRadiansPerDegree));
}

TEST(ReferencePose, WarnsOfBonesOutsideOfTheMesh) {
  Model tube = bent_tube();
  EXPECT_TRUE(reference_pose_faults(tube).empty());
  bend(tube, 10);  // a radius is 12 degrees at its end
  EXPECT_TRUE(reference_pose_faults(tube).empty());
  bend(tube, 80);
  const Diagnostics faults = reference_pose_faults(tube);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].code, "skin-reference-pose");
  EXPECT_EQ(faults[0].severity, Severity::warning);
  EXPECT_EQ(faults[0].joint, "tip");
  EXPECT_NE(faults[0].message.find("from lower to tip"), std::string::npos) << faults[0].message;
}

TEST(ReferencePose, DoesNotDependOnPlaceHolesOrTheSideOfFaces) {
  for (const double degrees : {0.0, 80.0}) {
    const std::size_t expected = degrees > 0 ? 1 : 0;
    Model tube = bent_tube();
    bend(tube, degrees);
    Model moved = tube;
    const Transform place{Vec3(10, -3, 5), from_rotation_vector(Vec3(0.4, 2, -1))};
    for (Vec3f& p : moved.positions) p = (place * p.cast<double>()).cast<float>();
    for (Transform& joint : moved.skeleton.reference) joint = place * joint;
    EXPECT_EQ(reference_pose_faults(moved).size(), expected);
    Model holed = tube;
    holed.triangles.erase(holed.triangles.begin() + 100, holed.triangles.begin() + 160);
    EXPECT_EQ(reference_pose_faults(holed).size(), expected);
    Model turned = tube;
    for (auto& triangle : turned.triangles) std::swap(triangle[0], triangle[1]);
    EXPECT_EQ(reference_pose_faults(turned).size(), expected);
  }
}

TEST(ReferencePose, SheetsAndEmptyMeshesHaveNoInside) {
  Model tube = bent_tube();
  tube.triangles.resize(40);
  EXPECT_TRUE(reference_pose_faults(tube).empty());
  tube.triangles.clear();
  EXPECT_TRUE(reference_pose_faults(tube).empty());
  EXPECT_TRUE(reference_pose_faults(Model()).empty());
}

}  // namespace
}  // namespace krok::test
