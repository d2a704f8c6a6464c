// SMD meshes, motions and lists of motions, read through Assimp. If these fail, joints stand or
// turn wrong, motions of a list are lost or taken for each other, or a list leads to files that are
// none of its business.

#include "unit/assimp/expectations.h"

namespace krok {
namespace {

using namespace test;

TEST(Smd, MotionAlone) {
  const MovingRig rig;
  const Folder folder;
  const auto scene = read_or_fail(folder.add("walk.smd", smd(rig, false, true)));
  expect_motion(scene, rig, {0.0, 1 / 30.0, 4 / 30.0, 6 / 30.0}, Mat4::Identity());
  EXPECT_TRUE(scene.meshes.empty());
  EXPECT_EQ(scene.animations[0].channels[0].times->size(), 4u);
  EXPECT_TRUE(has_code(scene.diagnostics, "assimp-rate"));
  EXPECT_FALSE(scene.space.metres || scene.space.file_to_krok);

  assimp::ReadOptions options;
  options.frames_per_second = 60;
  const auto fast = assimp::read_file(folder.add("walk.smd", smd(rig, false, true)), options);
  ASSERT_TRUE(fast.ok());
  expect_motion(*fast, rig, {0.0, 1 / 60.0, 4 / 60.0, 6 / 60.0}, Mat4::Identity());
}

TEST(Smd, MeshWithWeights) {
  const MovingRig rig;
  const Folder folder;
  const auto scene = read_or_fail(folder.add("body.smd", smd(rig, true, false)));
  expect_mesh(scene, Mat4::Identity());
  expect_weights(scene, rig.names);
  expect_winding(scene);
  EXPECT_TRUE(scene.animations.empty()) << "the rest pose is no motion";
  // A material's name may have spaces, where Assimp would lose its place.
  EXPECT_EQ(scene.meshes[0].primitives[0].material, "skin_of.bmp");
  EXPECT_FLOAT_EQ((*scene.meshes[0].primitives[0].texture_coordinates)[0][1], 0.25f);
}

TEST(Smd, MotionsOfAList) {
  const MovingRig rig;
  const Folder folder;
  const std::string path = folder.add("body.smd", smd(rig, true, false));
  const std::string motion = folder.add("anims/walk.smd", smd(rig, false, true));
  const std::string list = folder.add("body_animation.txt", "walking anims/walk.smd\n");
  const auto scene = read_or_fail(path);
  EXPECT_EQ(scene.files, (std::vector<std::string>{motion, list}));
  ASSERT_EQ(scene.animations.size(), 1u);
  EXPECT_EQ(scene.animations[0].name, "walking");
  expect_motion(scene, rig, {0.0, 1 / 30.0, 4 / 30.0, 6 / 30.0}, Mat4::Identity());
  expect_weights(scene, rig.names);
}

std::size_t keys_of(const nodes::Animation& animation) {
  std::size_t most = 0;
  for (const nodes::Channel& channel : animation.channels) {
    most = std::max(most, channel.times->size());
  }
  return most;
}

// Files of one name in two folders, one of the name that Assimp knows the mesh by, and one that is
// not there.
TEST(Smd, MotionsOfAListAreToldApart) {
  const MovingRig rig;
  MovingRig shorter = rig;
  shorter.frames.resize(2);
  const Folder folder;
  const std::string path = folder.add("body.smd", smd(rig, true, false));
  folder.add("a/walk.smd", smd(rig, false, true));
  folder.add("b/walk.smd", smd(shorter, false, true));
  folder.add("b/file.smd", smd(shorter, false, true));
  folder.add("body_animation.txt",
             "long a/walk.smd\nshort  b/walk.smd\nnone b/none.smd\nb/file.smd\n");
  const auto scene = read_or_fail(path);
  ASSERT_EQ(scene.animations.size(), 3u);
  EXPECT_EQ(scene.animations[0].name, "long");
  EXPECT_EQ(scene.animations[1].name, "short");
  EXPECT_EQ(scene.animations[2].name, "file");
  EXPECT_EQ(keys_of(scene.animations[0]), 4u);
  EXPECT_EQ(keys_of(scene.animations[1]), 2u);
  EXPECT_EQ(keys_of(scene.animations[2]), 2u);
  EXPECT_TRUE(has_code(scene.diagnostics, "assimp-companion")) << "b/none.smd";
}

TEST(Smd, OfALongListTheFirstMotionsAreTaken) {
  const MovingRig rig;
  const Folder folder;
  const std::string path = folder.add("body.smd", smd(rig, true, false));
  std::string list;
  for (int i = 0; i < 258; ++i) {
    folder.add(fmt::format("walk{}.smd", i), smd(rig, false, true));
    list += fmt::format("walk{}.smd\n", i);
  }
  folder.add("body_animation.txt", list);
  const auto scene = read_or_fail(path);
  ASSERT_EQ(scene.animations.size(), 256u);
  EXPECT_EQ(scene.animations[255].name, "walk255");
  EXPECT_TRUE(has_code(scene.diagnostics, "assimp-companion"));
}

TEST(Smd, OfMoreThanEightJointsTheLargestAreKept) {
  std::string text = "version 1\nnodes\n";
  for (int j = 0; j < 10; ++j) text += fmt::format("{} \"b{}\" {}\n", j, j, j - 1);
  text += "end\nskeleton\ntime 0\n";
  for (int j = 0; j < 10; ++j) text += fmt::format("{} 0 0 1 0 0 0\n", j);
  text += "end\ntriangles\nskin\n";
  for (int corner = 0; corner < 3; ++corner) {
    text += fmt::format("0 {} {} 0 0 0 1 0 0 10", corner % 2, corner / 2);
    // 1/55, 2/55 .. 10/55
    for (int j = 0; j < 10; ++j) text += fmt::format(" {} {:.9f}", j, (j + 1) / 55.0);
    text += "\n";
  }
  const Folder folder;
  const auto scene = read_or_fail(folder.add("many.smd", text + "end\n"));
  const nodes::Primitive& primitive = scene.meshes[0].primitives[0];
  ASSERT_EQ(primitive.influences_per_vertex, 8);
  double sum = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    const int node = scene.skins[0].joints[primitive.influence_joints[k]];
    EXPECT_EQ(scene.nodes[static_cast<std::size_t>(node)].name, fmt::format("b{}", 9 - k));
    EXPECT_NEAR(static_cast<double>(primitive.influence_weights[k]),
                static_cast<double>(10 - k) / 52.0, 1e-5);
    sum += static_cast<double>(primitive.influence_weights[k]);
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
  EXPECT_TRUE(has_code(scene.diagnostics, "assimp-influences"));
}

TEST(Smd, JointsOfOneNameAreWarnedOf) {
  MovingRig rig;
  rig.names = {"Hips", "Bone", "Bone"};
  const Folder folder;
  const auto scene = read_or_fail(folder.add("walk.smd", smd(rig, false, true)));
  EXPECT_TRUE(has_code(scene.diagnostics, "assimp-same-name"));
}

TEST(Smd, ListsLeadOutOfNoFolder) {
  const MovingRig rig;
  const Folder folder;
  folder.add("walk.smd", smd(rig, false, true));
  const std::string path = folder.add("deep/body.smd", smd(rig, true, false));
  folder.add("deep/body_animation.txt", "walking ../walk.smd\n");
  const auto scene = read_or_fail(path);
  EXPECT_TRUE(scene.animations.empty());
  EXPECT_TRUE(has_code(scene.diagnostics, "assimp-companion"));
}

}  // namespace
}  // namespace krok
