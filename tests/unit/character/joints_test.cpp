// If these fail, a character loses joints, gets those of another one in the same file, or takes
// props and cameras for bones.

#include <gtest/gtest.h>

#include "character/joints.h"
#include "character/rig.h"
#include "scenes.h"

namespace krok::test {
namespace {

using namespace character;

struct Chosen {
  std::vector<std::string> names;
  std::vector<int> parents;
  Diagnostics diagnostics;
  std::string error;  // its code
};

Chosen choose(const nodes::Scene& scene, const std::string& skin = "") {
  Chosen result;
  const auto evaluator = *nodes::Evaluator::create(scene);
  auto joints = choose_joints(scene, evaluator, skin, result.diagnostics);
  if (!joints) {
    result.error = joints.error().code;
    return result;
  }
  result.parents = joints->parents;
  auto rig = make_rig(scene, evaluator, std::move(*joints), result.diagnostics);
  EXPECT_TRUE(rig.ok());
  EXPECT_TRUE(check(rig->skeleton).ok());
  result.names = rig->skeleton.names;
  return result;
}

using Names = std::vector<std::string>;

TEST(Joints, WhatLiesBetweenAndBareBelowIsTaken) {
  nodes::Scene scene;
  const int root = add_node(scene, "Scene", -1);
  const int hips = add_node(scene, "Hips", root);
  scene.nodes[static_cast<std::size_t>(add_node(scene, "Lamp", hips))].fixture = true;
  const int left = add_node(scene, "LeftLeg", hips);
  const int twist = add_node(scene, "LeftTwist", left);
  const int foot = add_node(scene, "LeftFoot", twist);
  const int right = add_node(scene, "RightLeg", hips);
  add_node(scene, "Toe_end", foot);
  const int socket = add_node(scene, "Socket", foot);
  add_mesh(scene, "Shoe", socket, -1);
  const int camera = add_node(scene, "Eye", foot);
  scene.cameras.push_back({"Eye", true, 1.0});
  scene.nodes[static_cast<std::size_t>(camera)].camera = 0;
  const int skin = add_skin(scene, "Body", {foot, left, right});
  add_mesh(scene, "Body", root, skin);
  const Chosen chosen = choose(scene);
  EXPECT_EQ(chosen.names,
            (Names{"Hips", "LeftLeg", "LeftTwist", "LeftFoot", "Toe_end", "RightLeg"}));
  EXPECT_EQ(chosen.parents, (std::vector<int>{-1, 0, 1, 2, 3, 0}));
}

TEST(Joints, TheOrderOfTheSkinIsKept) {
  nodes::Scene scene;
  const int hips = add_node(scene, "Hips", -1);
  const int left = add_node(scene, "Left", hips);
  const int right = add_node(scene, "Right", hips);
  const int tip = add_node(scene, "LeftTip", left);
  add_mesh(scene, "Body", -1, add_skin(scene, "Body", {hips, right, left, tip}));
  EXPECT_EQ(choose(scene).names, (Names{"Hips", "Right", "Left", "LeftTip"}));
}

TEST(Joints, OfTwoSkeletonsTheLargerOrTheNamedOne) {
  nodes::Scene scene;
  const int root = add_node(scene, "Root", -1);
  const int cat = add_node(scene, "Cat", root);
  const int man = add_node(scene, "Man", root);
  const int arm = add_node(scene, "Arm", man);
  const int cat_skin = add_skin(scene, "CatSkin", {cat});
  const int man_skin = add_skin(scene, "ManSkin", {man, arm});
  add_mesh(scene, "CatMesh", root, cat_skin);
  add_mesh(scene, "ManMesh", root, man_skin);
  Chosen chosen = choose(scene);
  EXPECT_EQ(chosen.names, (Names{"Man", "Arm"}));
  ASSERT_TRUE(has_code(chosen.diagnostics, "scene-skeletons"));
  EXPECT_NE(chosen.diagnostics[0].hint.find("CatSkin"), std::string::npos);
  EXPECT_EQ(choose(scene, "CatSkin").names, Names{"Cat"});
  EXPECT_EQ(choose(scene, "0").names, Names{"Cat"});
  EXPECT_EQ(choose(scene, "Dog").error, "scene-skin");
  EXPECT_EQ(choose(scene, "2").error, "scene-skin");
}

TEST(Joints, SkinsOfPartsOfOneSkeletonBelongTogether) {
  nodes::Scene scene;
  const int root = add_node(scene, "RootNode", -1);
  const int hips = add_node(scene, "Hips", root);  // in no skin
  const int arm = add_node(scene, "Arm", hips);
  const int leg = add_node(scene, "Leg", hips);
  const int finger = add_node(scene, "Finger", arm);
  for (const auto& [name, joint] : std::vector<std::pair<std::string, int>>{
           {"Sleeve", arm}, {"Trousers", leg}, {"Ring", finger}}) {
    const int skin = add_skin(scene, name, {joint});
    add_mesh(scene, name, root, skin);
  }
  const Chosen chosen = choose(scene);
  EXPECT_EQ(chosen.names, (Names{"Hips", "Arm", "Finger", "Leg"}));
  EXPECT_FALSE(has_code(chosen.diagnostics, "scene-skeletons"));
}

TEST(Joints, TreesWithoutACommonNodeGetOne) {
  nodes::Scene scene;
  const int body = add_node(scene, "Body", -1);
  const int target = add_node(scene, "IkTarget", -1);
  const int arm = add_node(scene, "Arm", body);
  add_mesh(scene, "Mesh", -1, add_skin(scene, "Skin", {body, arm, target}));
  const Chosen chosen = choose(scene);
  EXPECT_EQ(chosen.names, (Names{"Roots", "Body", "Arm", "IkTarget"}));
  EXPECT_EQ(chosen.parents, (std::vector<int>{-1, 0, 1, 0}));
  EXPECT_TRUE(has_code(chosen.diagnostics, "scene-roots"));
}

TEST(Joints, WithoutSkinsWhatMoves) {
  nodes::Scene scene;
  const int root = add_node(scene, "World", -1);
  const int hips = add_node(scene, "Hips", root);
  const int spine = add_node(scene, "Spine", hips);
  const int head = add_node(scene, "Head", spine);
  add_node(scene, "Head_end", head);
  const int dolly = add_node(scene, "Dolly", root);
  const int camera = add_node(scene, "Camera", dolly);
  scene.cameras.push_back({"", true, 1.0});
  scene.nodes[static_cast<std::size_t>(camera)].camera = 0;
  nodes::Animation animation;
  for (const int node : {hips, head, dolly, camera}) {
    add_channel(animation, node, nodes::Path::rotation, 4, {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
  }
  scene.animations.push_back(animation);
  EXPECT_EQ(choose(scene).names, (Names{"Hips", "Spine", "Head", "Head_end"}));
  scene.animations.clear();
  EXPECT_EQ(choose(scene).names, (Names{"World", "Hips", "Spine", "Head", "Head_end"}));
}

nodes::Animation turning(const std::vector<int>& nodes) {
  nodes::Animation animation;
  for (const int node : nodes) {
    add_channel(animation, node, nodes::Path::rotation, 4, {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0});
  }
  return animation;
}

// Legs that no skin has, under a parent that none has either.
TEST(Joints, AnimatedPartsBesideTheSkinAndTheirParentAreTaken) {
  nodes::Scene scene;
  const int root = add_node(scene, "Scene", -1);
  const int body = add_node(scene, "Body", root);
  const int spine = add_node(scene, "Spine", body);
  const int leg = add_node(scene, "Leg", body);
  const int foot = add_node(scene, "Foot", leg);
  const int ball = add_mesh(scene, "Ball", root, -1);
  add_node(scene, "Anchor", root);
  add_mesh(scene, "Skin", root, add_skin(scene, "Skin", {spine}));
  EXPECT_EQ(choose(scene).names, (Names{"Spine"}));
  scene.animations.push_back(turning({body, leg, foot, ball}));
  const Chosen chosen = choose(scene);
  EXPECT_EQ(chosen.names, (Names{"Body", "Spine", "Leg", "Foot"}));
  Names left_out;
  for (const Diagnostic& one : chosen.diagnostics) {
    if (one.code == "scene-left-out") left_out.push_back(one.message);
  }
  ASSERT_EQ(left_out.size(), 2u);
  EXPECT_NE(left_out[0].find("1 animated node outside of the skeleton, left out: node 5 (Ball)"),
            std::string::npos)
      << left_out[0];
  EXPECT_NE(left_out[1].find("(Anchor)"), std::string::npos) << left_out[1];
  // A constant channel, as exporters write for every object, moves nothing.
  for (nodes::Channel& channel : scene.animations[0].channels) {
    channel.values = shared<float>({0, 0, 0, 1, 0, 0, 0, -1});
  }
  EXPECT_EQ(choose(scene).names, (Names{"Spine"}));
}

TEST(Joints, RootsThatStandStillAreTakenByNameOrAsTheFileCallsThem) {
  nodes::Scene scene;
  const int world = add_node(scene, "World", -1);
  const int first = add_node(scene, "mixamorig:Hips", world);
  const int spine = add_node(scene, "Spine", first);
  add_node(scene, "Leg", first);
  scene.animations.push_back(turning({spine}));
  EXPECT_EQ(choose(scene).names, (Names{"mixamorig:Hips", "Spine", "Leg"}));
  scene.nodes[static_cast<std::size_t>(first)].name = "Base";
  EXPECT_EQ(choose(scene).names, (Names{"Spine"}));
  scene.nodes[static_cast<std::size_t>(first)].bone = true;
  EXPECT_EQ(choose(scene).names, (Names{"Base", "Spine", "Leg"}));
}

TEST(Joints, AnotherSkeletonUnderTheSameNodeIsNoPart) {
  nodes::Scene scene;
  const int stage = add_node(scene, "Stage", -1);
  const int man = add_node(scene, "Man", stage);
  const int arm = add_node(scene, "Arm", man);
  const int cat = add_node(scene, "Cat", stage);
  const int tail = add_node(scene, "Tail_end", cat);
  const int cat_skin = add_skin(scene, "CatSkin", {cat});
  add_mesh(scene, "ManMesh", stage, add_skin(scene, "ManSkin", {man, arm}));
  add_mesh(scene, "CatMesh", stage, cat_skin);
  scene.animations.push_back(turning({stage, man, cat, tail}));
  const Chosen chosen = choose(scene);
  EXPECT_EQ(chosen.names, (Names{"Man", "Arm"}));
  EXPECT_TRUE(has_code(chosen.diagnostics, "scene-skeletons"));
  EXPECT_FALSE(has_code(chosen.diagnostics, "scene-left-out"));
}

TEST(Joints, NothingToTakeIsAnError) {
  nodes::Scene scene;
  EXPECT_EQ(choose(scene).error, "scene-skeleton");
  const int camera = add_node(scene, "Camera", -1);
  scene.cameras.push_back({"", true, 1.0});
  scene.nodes[static_cast<std::size_t>(camera)].camera = 0;
  EXPECT_EQ(choose(scene).error, "scene-skeleton");
}

TEST(Joints, NamesBecomeUnique) {
  nodes::Scene scene;
  const int root = add_node(scene, "", -1);
  const int a = add_node(scene, "Arm", root);
  add_node(scene, "Arm", a);
  add_node(scene, "Arm_2", a);
  add_node(scene, "", a);
  const Chosen chosen = choose(scene);
  EXPECT_EQ(chosen.names, (Names{"node_0", "Arm", "Arm_3", "Arm_2", "node_4"}));
  EXPECT_TRUE(has_code(chosen.diagnostics, "scene-joint-names"));
}

}  // namespace
}  // namespace krok::test
