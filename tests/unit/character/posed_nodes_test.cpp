// If these fail, a file without a mesh whose nodes are in a pose of its motion makes heads, chests
// and headings turn by that pose.

#include <gtest/gtest.h>

#include "character/motion.h"
#include "retarget/stance.h"
#include "unit/character/scenes.h"
#include "unit/retarget/actors.h"

namespace krok::character {
namespace {

// A motion with an animation of all joints, whose nodes without it are in frame 10 of it, turned by
// 80 degrees and with the head aside.
nodes::Scene posed_scene(const Clip& motion) {
  const Skeleton& skeleton = motion.skeleton;
  nodes::Scene scene;
  scene.space = {1.0, Quat::Identity()};
  nodes::Animation animation;
  const auto times = test::even_times(motion.frame_count(), motion.rate);
  std::vector<Transform> world(skeleton.names.size()), local(skeleton.names.size());
  std::vector<std::vector<float>> turns(skeleton.names.size());
  std::vector<float> places;
  const auto local_at = [&](int frame) {
    motion.get_pose(frame, world);
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const int parent = skeleton.parents[test::at(j)];
      local[test::at(j)] =
          parent < 0 ? world[0] : world[test::at(parent)].inverse() * world[test::at(j)];
    }
  };
  for (int f = 0; f < motion.frame_count(); ++f) {
    local_at(f);
    for (std::size_t j = 0; j < local.size(); ++j) {
      const Vec4f turn = local[j].orientation.coeffs().cast<float>();
      turns[j].insert(turns[j].end(), turn.begin(), turn.end());
    }
    for (const double place : local[0].position) places.push_back(static_cast<float>(place));
  }
  local_at(10);
  local[0].orientation =
      from_rotation_vector(80 * kRadiansPerDegree * Vec3::UnitY()) * local[0].orientation;
  Quat& head = local[test::at(skeleton.find("Head"))].orientation;
  head = head * from_rotation_vector(40 * kRadiansPerDegree * Vec3::UnitY());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Transform& rest = local[test::at(j)];
    test::add_node(scene, skeleton.names[test::at(j)], skeleton.parents[test::at(j)], rest.position,
                   rest.orientation);
    test::add_channel(animation, j, nodes::Path::rotation, 4, times, turns[test::at(j)]);
  }
  test::add_channel(animation, 0, nodes::Path::translation, 3, times, places);
  scene.animations.push_back(std::move(animation));
  return scene;
}

struct ReadMotion {
  Clip clip;
  Diagnostics found;
};

ReadMotion read_motion(const nodes::Scene& scene) {
  ReadMotion result;
  const auto evaluator = nodes::Evaluator::create(scene);
  const auto rig = find_rig(scene, *evaluator, "", result.found);
  const RoleMap roles = find_roles(rig->skeleton);
  CaptureOptions how;
  how.up = Direction::plus_y;
  how.forward = Direction::plus_z;
  how.unit = Unit{};
  const auto place = place_scene(scene, *evaluator, &*rig, roles, 0, how, "x.glb", result.found);
  const auto sampling = choose_sampling(scene.animations[0], {}, result.found);
  auto clip =
      make_motion(*evaluator, *rig, roles, *place, 0, *sampling, 1, nullptr, result.found, nullptr);
  EXPECT_TRUE(clip.ok());
  if (clip) result.clip = *std::move(clip);
  return result;
}

TEST(PosedNodes, HaveTheirReferencePoseFromTheMotion) {
  const Clip motion = test::lively_clip(test::human_skeleton());
  const auto [clip, found] = read_motion(posed_scene(motion));
  ASSERT_EQ(clip.joint_count(), motion.joint_count());
  EXPECT_TRUE(test::has_code(found, "scene-pose"));
  EXPECT_FALSE(test::has_code(found, "scene-forward"));
  EXPECT_LT(test::largest_distance(clip, motion), 1e-5);  // the motion is as it was
  for (const char* joint : {"Hips", "Spine2", "Head", "LeftUpLeg", "RightUpLeg"}) {
    const std::size_t j = test::at(clip.skeleton.find(joint));
    EXPECT_LT(angle_between(clip.skeleton.reference[j].orientation, Quat::Identity()),
              8 * kRadiansPerDegree)
        << joint;
  }
  EXPECT_FALSE(retarget::is_frame_of_motion(clip.skeleton, find_roles(clip.skeleton)));
}

TEST(PosedNodes, OfAMeshAreItsReferencePose) {
  const Clip motion = test::lively_clip(test::human_skeleton());
  nodes::Scene scene = posed_scene(motion);
  test::add_mesh(scene, "Prop", 0, -1);
  const Clip clip = read_motion(scene).clip;
  EXPECT_TRUE(retarget::is_frame_of_motion(clip.skeleton, find_roles(clip.skeleton)));
}

TEST(PosedNodes, AreNoPoseThatIsTheSameOnBothSides) {
  Skeleton a_pose = test::human_skeleton();
  const RoleMap roles = find_roles(a_pose);
  EXPECT_FALSE(retarget::is_frame_of_motion(a_pose, roles));
  for (const double side : {1.0, -1.0}) {
    a_pose = test::posed(a_pose, side > 0 ? "LeftArm" : "RightArm",
                         from_rotation_vector(-0.8 * side * Vec3::UnitZ()));
  }
  EXPECT_FALSE(retarget::is_frame_of_motion(a_pose, roles));
  for (Transform& joint : a_pose.reference) {  // of VRM 0, which faces -Z
    joint = Transform{Vec3::Zero(), from_rotation_vector(kPi * Vec3::UnitY())} * joint;
  }
  EXPECT_FALSE(retarget::is_frame_of_motion(a_pose, roles));
  EXPECT_TRUE(retarget::is_frame_of_motion(
      test::posed(a_pose, "LeftUpLeg", from_rotation_vector(0.5 * Vec3::UnitX())), roles));
}

}  // namespace
}  // namespace krok::character
