// If these fail, a scene's axes are worked out from other roles than those that its importer knows.

#include <gtest/gtest.h>

#include <algorithm>

#include "character/space.h"
#include "support/human_skeleton.h"

namespace krok::character {
namespace {

// Left and right exchanged.
RoleMap mirrored(RoleMap map) {
  for (Role& role : map.roles) {
    std::string name(role_name(role));
    if (name.starts_with("left_")) {
      role = *parse_role("right_" + name.substr(5));
    } else if (name.starts_with("right_")) {
      role = *parse_role("left_" + name.substr(6));
    }
  }
  return map;
}

TEST(SceneConventions, GoByTheRolesThatAreKnown) {
  Rig rig;
  rig.skeleton = test::human_skeleton();
  const RoleMap roles = find_roles(rig.skeleton);
  const Conventions found = find_conventions({}, &rig, roles, {}, {});
  EXPECT_EQ(found.forward, Direction::plus_z);
  EXPECT_EQ(found.forward_confidence, Confidence::certain);
  EXPECT_EQ(find_conventions({}, &rig, mirrored(roles), {}, {}).forward, Direction::minus_z);
  EXPECT_EQ(find_conventions({}, &rig, {}, {}, {}).forward_confidence, Confidence::guess);
}

// A file that says which axis is up is believed, whatever its skeleton looks like.
TEST(SceneConventions, TheFilesUpAxisIsNotGuessed) {
  Rig rig;
  rig.skeleton = test::human_skeleton();
  const RoleMap roles = find_roles(rig.skeleton);
  for (Transform& joint : rig.skeleton.reference) {  // hanging by its feet
    joint.position.y() *= -1;
    joint.position.x() *= -1;
  }
  EXPECT_EQ(find_conventions({}, &rig, roles, {}, {}).up, Direction::minus_y);
  nodes::Space space;
  space.up_is_y = true;
  const Conventions found = find_conventions(space, &rig, roles, {}, {});
  EXPECT_EQ(found.up, Direction::plus_y);
  EXPECT_EQ(found.up_confidence, Confidence::certain);
  GivenConventions given;
  given.up = Direction::plus_z;
  EXPECT_EQ(find_conventions(space, &rig, roles, {}, given).up, Direction::plus_z);
}

TEST(SceneConventions, AnOddSizeOfAPersonIsTold) {
  const Skeleton skeleton = test::human_skeleton();
  const RoleMap roles = find_roles(skeleton);
  // As exporters make them that scale by 100 once too often or once too seldom; and a giant's, a
  // doll's and a child's, which may be meant.
  for (const double scale : {0.01, 100.0, 0.05, 2.0, 0.5, 0.6}) {
    Skeleton scaled = skeleton;
    for (Transform& joint : scaled.reference) joint.position *= scale;
    Diagnostics found;
    check_size(scaled, roles, found);
    const bool odd = scale < 0.1 || scale > 10;
    ASSERT_EQ(found.size(), odd ? 1u : 0u) << scale;
    if (!odd) continue;
    EXPECT_EQ(found[0].code, "scene-unit");
    found.clear();
    check_size(scaled, {}, found);
    EXPECT_EQ(found.size(), scale < 1 ? 0u : 1u) << "no other animal is so large, many are small";
  }
}

TEST(SceneConventions, ActorsAreCheckedByTheRolesThatAreKnown) {
  const Skeleton skeleton = test::human_skeleton();
  const RoleMap roles = find_roles(skeleton);
  Diagnostics found;
  check_actor(skeleton, roles, found);
  EXPECT_TRUE(found.empty());
  Skeleton turned = skeleton;  // by half a turn about +Y
  for (Transform& joint : turned.reference) joint.position.x() *= -1, joint.position.z() *= -1;
  check_actor(turned, roles, found);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].code, "scene-forward");
  found.clear();
  check_actor(turned, {}, found);
  EXPECT_TRUE(found.empty()) << "of what is no humanoid nothing is expected";
}

}  // namespace
}  // namespace krok::character
