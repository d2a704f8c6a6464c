// The formats read through Assimp against plain forward kinematics over the same numbers. If these
// fail, joints stand or turn wrong, move at another speed, or lose weights, keys or names, without
// anything being said. SMD has a file of its own.

#include "unit/assimp/expectations.h"

namespace krok {
namespace {

using namespace test;

TEST(Md5, MeshAndMotionFindEachOther) {
  const MovingRig rig;
  const Folder folder;
  const std::vector<double> times = {0.0, 1 / 24.0, 2 / 24.0, 3 / 24.0};
  MovingRig moved = rig;  // joint 1 only turns
  for (auto& poses : moved.frames) poses[1].translation = moved.frames[0][1].translation;
  const std::string mesh = folder.add("body.md5mesh", md5mesh(rig));
  const std::string motion = folder.add("body.md5anim", md5anim(moved));
  EXPECT_EQ(read_or_fail(mesh).files, std::vector<std::string>{motion});
  EXPECT_EQ(read_or_fail(motion).files, std::vector<std::string>{mesh});
  for (const std::string& path : {mesh, motion}) {
    const auto scene = read_or_fail(path);
    // Joint 2 rests, in the motion's base frame and not in the mesh's pose.
    expect_motion(scene, moved, times, z_up_to_y_up());
    expect_mesh(scene, z_up_to_y_up());
    expect_weights(scene, rig.names);
    expect_winding(scene);
    EXPECT_TRUE(has_code(scene.diagnostics, "assimp-companion"));
    EXPECT_TRUE(has_code(scene.diagnostics, "assimp-normals"));
    EXPECT_EQ(scene.meshes[0].primitives[0].material, "skin");
    EXPECT_FLOAT_EQ((*scene.meshes[0].primitives[0].texture_coordinates)[0][1], 0.75f);
  }
  // A motion of another name takes the only mesh that has its joints.
  const auto other = read_or_fail(folder.add("walk.md5anim", md5anim(moved)));
  EXPECT_EQ(other.meshes.size(), 1u);
  EXPECT_EQ(other.files, std::vector<std::string>{mesh});
  expect_motion(other, moved, times, z_up_to_y_up());
}

TEST(Md5, MotionAlone) {
  MovingRig rig;
  for (auto& poses : rig.frames) poses[1].translation = rig.frames[0][1].translation;
  const Folder folder;
  const std::string path = folder.add("walk.md5anim", md5anim(rig));
  const std::vector<double> times = {0.0, 1 / 24.0, 2 / 24.0, 3 / 24.0};
  const auto scene = read_or_fail(path);
  expect_motion(scene, rig, times, z_up_to_y_up());
  EXPECT_TRUE(scene.meshes.empty()) << "Assimp's mesh for show is no mesh of the file";
  // A mesh with other joints is not taken.
  MovingRig stranger;
  stranger.names = {"pelvis", "chest", "skull"};
  folder.add("walk.md5mesh", md5mesh(stranger));
  const auto again = read_or_fail(path);
  EXPECT_TRUE(again.meshes.empty());
  EXPECT_TRUE(again.files.empty());
  EXPECT_TRUE(has_code(again.diagnostics, "assimp-companion"));
}

TEST(Md5, FramesThatLackNumbersAreRefused) {
  const MovingRig rig;
  const Folder folder;
  std::string text = md5anim(rig);
  const std::size_t frame = text.find("frame 2 {");
  text.erase(text.find_first_of("-0123456789", frame + 9), 3);
  text.insert(frame + 9, " ");
  const std::size_t begin = text.find("frame 2 {") + 9;
  const std::size_t number = text.find_first_not_of(" \t\n", begin);
  text.erase(number, text.find_first_of(" \t\n", number) - number);
  const auto scene = assimp::read_file(folder.add("walk.md5anim", text));
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, "assimp-refused");
  EXPECT_NE(scene.error().message.find("frame 2"), std::string::npos) << scene.error().message;
}

TEST(Ms3d, KeysAreInTheJointsOwnAxes) {
  const MovingRig rig;
  const Folder folder;
  const auto scene = read_or_fail(folder.add("body.ms3d", ms3d(rig)));
  expect_motion(scene, rig, kTimes, Mat4::Identity());
  expect_mesh(scene, Mat4::Identity());
  expect_winding(scene);
}

TEST(Ms3d, UpToFourWeightsAVertex) {
  const MovingRig rig;
  const Folder folder;
  expect_weights(read_or_fail(folder.add("body.ms3d", ms3d(rig))), rig.names);
  // Without the later part each vertex hangs on one joint.
  const auto single = read_or_fail(folder.add("old.ms3d", ms3d(rig, false)));
  const nodes::Primitive& primitive = single.meshes[0].primitives[0];
  for (std::size_t v = 0; v < primitive.vertex_count(); ++v) {
    EXPECT_FLOAT_EQ(primitive.influence_weights[v * 4], 1.0f);
  }
}

TEST(Ms3d, AFrameRateOfNoughtLosesNoKeys) {
  const MovingRig rig;
  const Folder folder;
  const auto scene = read_or_fail(folder.add("body.ms3d", ms3d(rig, true, 0.0f)));
  expect_motion(scene, rig, kTimes, Mat4::Identity());
}

TEST(Collada, CurvesOfOneNodeInSeveralAnimations) {
  MovingRig rig;
  for (auto& poses : rig.frames) {
    poses[1].translation = rig.rest[1].translation;
    poses[2] = rig.rest[2];
  }
  rig.frames[3][1].angles[1] = rig.frames[2][1].angles[1];  // that curve ends before
  const Folder folder;
  const auto scene = read_or_fail(folder.add("body.dae", collada(rig)));
  const Mat4 turn = z_up_to_y_up() * (Vec4(0.01, 0.01, 0.01, 1).asDiagonal().toDenseMatrix());
  ASSERT_EQ(scene.animations.size(), 1u);
  for (std::size_t f = 0; f < rig.frames.size(); ++f) {
    const auto world = rig.to_world(rig.frames[f]);
    for (std::size_t j = 0; j < world.size(); ++j) {
      expect_near(node_to_world(scene, rig.names[j], 0, kTimes[f]), turn * world[j].matrix(), 1e-6,
                  fmt::format("joint {} in frame {}", rig.names[j], f));
    }
  }
  expect_mesh(scene, turn);
  expect_weights(scene, rig.names);
  expect_winding(scene);
  EXPECT_EQ(scene.space.metres, 1.0);
  EXPECT_FALSE(read_or_fail(folder.add("bare.dae", collada(rig, false))).space.metres);
}

// As Blender writes them: several cameras, by the horizontal field of view. Without this they are
// left out, since Assimp reads none of it.
TEST(Collada, CamerasOfDifferentHorizontalFieldsOfView) {
  const Folder folder;
  std::string text = collada(MovingRig());
  const std::string lens =
      "<camera id=\"{}\"><optics><technique_common><perspective><xfov sid=\"xfov\">{}</xfov>"
      "<aspect_ratio>{}</aspect_ratio><znear>0.1</znear><zfar>100</zfar></perspective>"
      "</technique_common></optics></camera>";
  text.insert(text.find("</library_cameras>"), fmt::format(fmt::runtime(lens), "wide", 90, 2) +
                                                   fmt::format(fmt::runtime(lens), "far", 20, 1));
  text.insert(text.find("</visual_scene>"),
              "<node id=\"a\" name=\"a\"><node id=\"b\" name=\"b\"><instance_camera "
              "url=\"#far\"/></node><instance_camera url=\"#wide\"/></node>");
  const auto scene = read_or_fail(folder.add("shots.dae", text));
  std::map<std::string, double> degrees;
  for (const nodes::Camera& camera : scene.cameras) {
    degrees[camera.name] = camera.field_of_view / kRadiansPerDegree;
  }
  ASSERT_EQ(degrees.size(), 3U);
  EXPECT_NEAR(degrees["a"], 2 * std::atan(0.5) / kRadiansPerDegree, 1e-9);
  EXPECT_NEAR(degrees["b"], 20, 1e-9);
  EXPECT_NEAR(degrees["eye-node"], 40, 1e-9);
}

TEST(Collada, CameraWithAVerticalFieldOfViewAlone) {
  const Folder folder;
  const auto scene = read_or_fail(folder.add("shot.dae", collada(MovingRig())));
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_NEAR(scene.cameras[0].field_of_view, 40 * kRadiansPerDegree, 1e-9);
  const Mat4 eye = node_to_world(scene, "eye", -1, 0);
  EXPECT_EQ(scene.nodes[static_cast<std::size_t>(node_named(scene, "eye"))].camera, 0);
  EXPECT_LT((eye.topRightCorner<3, 1>() - Vec3(0, 0.01, 0.05)).norm(), 1e-6);
  const Vec3 forward = -eye.block<3, 1>(0, 2).normalized();
  EXPECT_LT((forward - Vec3(0, 0, -1)).norm(), 1e-6);
}

TEST(Collada, ClipsStayApart) {
  std::string text = collada(MovingRig());
  const std::string clips =
      "<library_animation_clips><animation_clip id=\"wave\" name=\"wave\"><instance_animation "
      "url=\"#hips-motion\"/></animation_clip><animation_clip id=\"bend\" start=\"0.1\" "
      "end=\"0.5\">"
      "<instance_animation url=\"#spine-X\"/></animation_clip></library_animation_clips>\n";
  text.insert(text.find("<library_visual_scenes>"), clips);
  const Folder folder;
  const auto scene = read_or_fail(folder.add("clips.dae", text));
  ASSERT_EQ(scene.animations.size(), 2u);
  EXPECT_EQ(scene.animations[0].name, "wave");
  EXPECT_EQ(scene.animations[1].name, "bend");
  // Each moves its own joint, the second over its own part of the time.
  const auto moved = [&](std::size_t animation) {
    std::set<std::string> joints;
    for (const nodes::Channel& channel : scene.animations[animation].channels) {
      joints.insert(scene.nodes[static_cast<std::size_t>(channel.node)].name);
    }
    return joints;
  };
  EXPECT_EQ(moved(0), std::set<std::string>{"Hips"});
  EXPECT_EQ(moved(1), std::set<std::string>{"Spine"});
  const std::vector<float>& times = *scene.animations[1].channels[0].times;
  EXPECT_FLOAT_EQ(times.front(), 0.0f);
  EXPECT_FLOAT_EQ(times.back(), 0.4f);
}

// As some exporters write all their lists: a 0 too many shifts every index.
TEST(Collada, WhiteSpaceBeforeNumbers) {
  const MovingRig rig;
  const Folder folder;
  std::string text = collada(rig);
  for (const char* element : {"p", "v", "vcount", "float_array", "Name_array", "matrix",
                              "translate", "bind_shape_matrix"}) {
    const std::string begin = std::string("<") + element;
    for (std::size_t at = text.find(begin); at != std::string::npos;
         at = text.find(begin, at + 1)) {
      const char next = text[at + begin.size()];
      if (next == '>' || next == ' ') text.insert(text.find('>', at) + 1, " \n\t");
    }
  }
  const auto plain = read_or_fail(folder.add("plain.dae", collada(rig)));
  const auto spaced = read_or_fail(folder.add("spaced.dae", text));
  expect_weights(spaced, rig.names);
  ASSERT_EQ(spaced.meshes.size(), 1U);
  EXPECT_EQ(*spaced.meshes[0].primitives[0].positions, *plain.meshes[0].primitives[0].positions);
  EXPECT_EQ(spaced.meshes[0].primitives[0].triangles, plain.meshes[0].primitives[0].triangles);
  ASSERT_EQ(spaced.animations.size(), 1U);
  for (const std::string& name : rig.names) {
    expect_near(node_to_world(spaced, name, 0, 0.3), node_to_world(plain, name, 0, 0.3), 1e-6,
                name);
  }
}

TEST(Collada, TheUpAxisIsTheFiles) {
  const Folder folder;
  const std::string text = collada(MovingRig());
  EXPECT_TRUE(read_or_fail(folder.add("with.dae", text)).space.up_is_y);
  std::string without = text;
  without.erase(without.find("<up_axis>"), std::string("<up_axis>Z_UP</up_axis>").size());
  EXPECT_FALSE(read_or_fail(folder.add("without.dae", without)).space.up_is_y);
}

TEST(Collada, LightsAreNoJoints) {
  const Folder folder;
  std::string text = collada(MovingRig());
  text.insert(text.find("<library_cameras>"),
              "<library_lights><light id=\"sun-light\"><technique_common><point><color>1 1 1"
              "</color></point></technique_common></light></library_lights>\n");
  const std::string scene_begin = "<visual_scene ";
  text.insert(text.find('>', text.find(scene_begin)) + 1,
              "<node id=\"sun\" name=\"sun\"><instance_light url=\"#sun-light\"/></node>");
  const auto scene = read_or_fail(folder.add("lit.dae", text));
  EXPECT_TRUE(scene.nodes[static_cast<std::size_t>(node_named(scene, "sun"))].fixture);
  EXPECT_FALSE(scene.nodes[static_cast<std::size_t>(node_named(scene, "Hips"))].fixture);
}

// A whole file in UTF-16, in both byte orders.
std::string utf16(const std::string& text, bool big) {
  std::string out = big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) {
    if (big) out += '\0';
    out += c;
    if (!big) out += '\0';
  }
  return out;
}

TEST(Utf16, IsReadAsTheTextThatItIs) {
  const Folder folder;
  const MovingRig rig;
  const auto plain = read_or_fail(folder.add("plain.ase", ase()));
  for (const bool big : {false, true}) {
    const auto scene = read_or_fail(folder.add(big ? "big.ase" : "little.ase", utf16(ase(), big)));
    ASSERT_EQ(scene.meshes.size(), 1U);
    EXPECT_EQ(*scene.meshes[0].primitives[0].positions, *plain.meshes[0].primitives[0].positions);
    ASSERT_EQ(scene.animations.size(), 1U);
    EXPECT_EQ(scene.cameras.size(), 1U);
    // Its unit and names are found in the text beside Assimp.
    const auto skinned = read_or_fail(folder.add("body.dae", utf16(collada(rig), big)));
    expect_weights(skinned, rig.names);
    EXPECT_EQ(skinned.space.metres, 1.0);
  }
}

TEST(Max3ds, ARolledCamera) {
  const Folder folder;
  const auto scene = read_or_fail(folder.add("rolled.3ds", max_3ds(90.0f)));
  ASSERT_EQ(scene.cameras.size(), 1u);
  const Mat4 eye = node_to_world(scene, "eye_camera", -1, 0);
  EXPECT_LT((eye.block<3, 1>(0, 2) - Vec3(0, 0, 1)).norm(), 1e-5);  // looks the same way
  EXPECT_NEAR(std::abs(eye(0, 1)), 1.0, 1e-5);                      // on its side
}

TEST(Max3ds, KeysAndCamera) {
  const Folder folder;
  const auto scene = read_or_fail(folder.add("body.3ds", max_3ds()));
  ASSERT_EQ(scene.animations.size(), 1u);
  const auto at = [&](double time) {
    return Vec3(node_to_world(scene, "body", 0, time).topRightCorner<3, 1>());
  };
  const nodes::Channel& channel = scene.animations[0].channels[0];
  ASSERT_EQ(channel.times->size(), 3u);
  const double frame = static_cast<double>((*channel.times)[2]) / 10;
  EXPECT_NEAR(static_cast<double>((*channel.times)[1]), 4 * frame, 1e-6);
  EXPECT_NEAR(at(4 * frame)[0], 0.5, 1e-6);
  EXPECT_NEAR(at(10 * frame)[0], 2.0, 1e-6);
  ASSERT_EQ(scene.cameras.size(), 1u);
  // A lens of 50 mm sees 48 degrees across, a picture of 4:3 36.9 upright.
  EXPECT_NEAR(scene.cameras[0].field_of_view,
              2 * std::atan(std::tan(24 * kRadiansPerDegree) * 0.75), 1e-5);
  const Mat4 eye = node_to_world(scene, "eye_camera", -1, 0);
  EXPECT_LT((eye.topRightCorner<3, 1>() - Vec3(0, 1, 5)).norm(), 1e-5);
  EXPECT_LT((eye.block<3, 1>(0, 2) - Vec3(0, 0, 1)).norm(), 1e-5);
  EXPECT_LT((eye.block<3, 1>(0, 1) - Vec3(0, 1, 0)).norm(), 1e-5);
  EXPECT_TRUE(has_code(scene.diagnostics, "assimp-no-skeleton"));
}

// As above: the key's turn comes after those before it, so that it is on the left of the product.
TEST(Max3ds, TurnsAboutSeveralAxes) {
  const Folder folder;
  const std::vector<Vec3> turns = {{0, 0, 0}, {0, 0, 1.5}, {1.2, 0, 0}, {0.3, -0.9, 0.4}};
  const auto scene = read_or_fail(folder.add("turns.3ds", max_3ds(0.0f, turns)));
  ASSERT_EQ(scene.animations.size(), 1u);
  const double frame = 1 / 25.0;  // Assimp's, for want of a rate
  const Mat3 turned = z_up_to_y_up().topLeftCorner<3, 3>();
  Mat3 product = Mat3::Identity();
  for (std::size_t k = 0; k < turns.size(); ++k) {
    const Vec3 axis = turns[k].norm() > 0 ? Vec3(turns[k].normalized()) : Vec3::UnitZ();
    product = Eigen::AngleAxisd(-turns[k].norm(), axis) * product;
    const Mat4 body = node_to_world(scene, "body", 0, static_cast<double>(k) * frame);
    const Mat3 off = body.topLeftCorner<3, 3>() - turned * product;
    EXPECT_LT(off.norm(), 1e-5) << "key " << k;
  }
}

TEST(Ase, SamplesAndCamera) {
  const Folder folder;
  const auto scene = read_or_fail(folder.add("body.ase", ase()));
  ASSERT_EQ(scene.animations.size(), 1u);
  const auto at = [&](double time) { return node_to_world(scene, "body", 0, time); };
  EXPECT_LT((at(640 / 4800.0).topRightCorner<3, 1>() - Vec3(1, 0, 0)).norm(), 1e-5);
  EXPECT_LT((at(1.0).topRightCorner<3, 1>() - Vec3(1, 0, -2)).norm(), 1e-5);
  // Each sample turns on from the one before, about the parent's axes; 3ds Max counts angles
  // clockwise.
  const Mat3 first = Eigen::AngleAxisd(-0.5, Vec3::UnitZ()).toRotationMatrix();
  const Mat3 second = Eigen::AngleAxisd(-0.25, Vec3::UnitX()) * first;
  for (const auto& [time, turned] : {std::pair(640 / 4800.0, first), std::pair(1.0, second)}) {
    const Mat3 expected = z_up_to_y_up().topLeftCorner<3, 3>() * turned;
    EXPECT_LT((at(time).topLeftCorner<3, 3>() - expected).norm(), 1e-5) << time;
  }
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_NEAR(scene.cameras[0].field_of_view, 2 * std::atan(std::tan(0.4) * 0.75), 1e-5);
  const Mat4 eye = node_to_world(scene, "eye", -1, 0);
  const int camera_node = node_named(scene, "eye");
  EXPECT_EQ(scene.nodes[static_cast<std::size_t>(camera_node)].camera, 0);
  EXPECT_LT((eye.topRightCorner<3, 1>() - Vec3(0, 1, 5)).norm(), 1e-5);
  EXPECT_LT((-eye.block<3, 1>(0, 2) - Vec3(0, 0, -1)).norm(), 1e-5);
}

TEST(Fbx, PivotsAndPreAndPostRotations) {
  const FbxSample sample;
  const Folder folder;
  const auto scene = read_or_fail(folder.add("body.fbx", sample.text()));
  ASSERT_EQ(scene.animations.size(), 1u);
  EXPECT_EQ(scene.animations[0].name, "Take 001");
  for (int key = -1; key < 3; ++key) {
    Mat4 world = Mat4::Identity();
    for (const FbxNode& node : sample.nodes) {
      const auto k = static_cast<std::size_t>(std::max(key, 0));
      world = world * node.to_parent(key < 0 ? node.rotation : node.keys[k]);
      expect_near(node_to_world(scene, node.name, key < 0 ? -1 : 0, sample.times[k]), world, 1e-3,
                  fmt::format("{} at key {}", node.name, key));
    }
  }
  for (const nodes::Node& node : scene.nodes) {
    EXPECT_EQ(node.name.find("$AssimpFbx$"), std::string::npos) << node.name;
  }
}

// Also of joints that no mesh is weighted to and no curve moves, of which Assimp keeps no mark.
TEST(Fbx, JointsAreKnown) {
  const Folder folder;
  const auto scene = read_or_fail(folder.add("body.fbx", FbxSample().text()));
  for (const nodes::Node& node : scene.nodes) {
    EXPECT_EQ(node.bone, node.name == "Hips" || node.name == "Spine") << node.name;
  }
}

TEST(Fbx, LayersThatAreBlendedAreWarnedOf) {
  std::string text = FbxSample().text();
  const Folder folder;
  EXPECT_FALSE(has_code(read_or_fail(folder.add("one.fbx", text)).diagnostics, "assimp-layers"));
  text.insert(text.find("AnimationLayer: 2001"),
              "AnimationLayer: 2002, \"AnimLayer::More\", \"\" {\n}\n");
  text.insert(text.find("Connections:  {\n") + 16, "C: \"OO\",2002,2000\n");
  EXPECT_TRUE(has_code(read_or_fail(folder.add("two.fbx", text)).diagnostics, "assimp-layers"));
}

// FBX's InheritType: Maya's segment scale compensation keeps joints below a scaled one as they are,
// MotionBuilder scales them along their own axes. All were scaled along the parent's.
TEST(Fbx, ScaleReachesChildrenAsTheFileSays) {
  const auto spine = [](const char* scaling, int inherit_type) {
    std::string text = FbxSample().text();
    const std::string active = "P: \"RotationActive\", \"bool\", \"\", \"\",1\n";
    const std::size_t first = text.find(active);
    text.insert(text.find(active, first + 1),
                fmt::format("P: \"InheritType\", \"enum\", \"\", \"\",{}\n", inherit_type));
    text.insert(first,
                fmt::format("P: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\",{}\n", scaling));
    const Folder folder;
    return node_to_world(read_or_fail(folder.add("scaled.fbx", text)), "Spine", -1, 0);
  };
  const Mat4 rigid = spine("1,1,1", 1), sheared = spine("2,1,1", 1);
  const Mat4 compensated = spine("2,1,1", 2), along = spine("2,1,1", 0);
  const auto linear = [](const Mat4& matrix) { return Mat3(matrix.topLeftCorner<3, 3>()); };
  EXPECT_LT((linear(compensated) - linear(rigid)).norm(), 1e-5);
  EXPECT_LT((linear(along) - linear(rigid) * Vec3(2, 1, 1).asDiagonal()).norm(), 1e-5);
  EXPECT_GT((linear(along) - linear(sheared)).norm(), 0.1) << "the sample's joints are turned";
  for (const Mat4& each : {compensated, along}) {
    EXPECT_LT((each - sheared).col(3).norm(), 1e-3) << "places are scaled in all of them";
  }
  EXPECT_LT((spine("2,2,2", 0) - spine("2,2,2", 1)).norm(), 1e-3);
}

// One take a stack: all are there by name, and one without curves is not lost silently.
TEST(Fbx, SeveralTakes) {
  std::string text = FbxSample().text();
  text.insert(text.find("AnimationStack: 2000"),
              "AnimationStack: 2100, \"AnimStack::Jump\", \"\" {\n}\n"
              "AnimationLayer: 2101, \"AnimLayer::JumpBase\", \"\" {\n}\n"
              "AnimationStack: 2200, \"AnimStack::Empty\", \"\" {\n}\n"
              "AnimationCurveNode: 3900, \"AnimCurveNode::T\", \"\" {\n}\n"
              "AnimationCurve: 3901, \"AnimCurve::\", \"\" {\nDefault: 0\nKeyVer: 4008\n"
              "KeyTime: *2 {\na: 0,46186158000\n}\nKeyValueFloat: *2 {\na: 90,150\n}\n}\n");
  text.insert(text.find("Connections:  {\n") + 16,
              "C: \"OO\",2101,2100\nC: \"OO\",3900,2101\n"
              "C: \"OP\",3900,1000, \"Lcl Translation\"\nC: \"OP\",3901,3900, \"d|Y\"\n");
  const Folder folder;
  const auto scene = read_or_fail(folder.add("takes.fbx", text));
  ASSERT_EQ(scene.animations.size(), 2U);
  std::vector<std::string> names = {scene.animations[0].name, scene.animations[1].name};
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"Jump", "Take 001"}));
  EXPECT_TRUE(has_code(scene.diagnostics, "assimp-takes"));
}

TEST(Fbx, TargetsRestWhereTheFileSays) {
  const FbxSample sample;
  const Folder folder;
  EXPECT_EQ(read_or_fail(folder.add("rest.fbx", sample.text())).meshes[0].weights,
            std::vector<double>{0.0});
  std::string text = sample.text();
  const std::size_t at = text.find("DeformPercent: 0");
  text.replace(at, 16, "DeformPercent: 25");
  EXPECT_EQ(read_or_fail(folder.add("lifted.fbx", text)).meshes[0].weights,
            std::vector<double>{0.25});
}

TEST(Fbx, TangentsWithTheSideOfTheThirdAxis) {
  const Folder folder;
  FbxSample sample;
  const auto scene = read_or_fail(folder.add("body.fbx", sample.text()));
  const nodes::Primitive& primitive = scene.meshes[0].primitives[0];
  ASSERT_TRUE(primitive.tangents);
  ASSERT_EQ(primitive.tangents->size(), 4u);
  for (std::size_t v = 0; v < 4; ++v) {
    const bool last = (*primitive.positions)[v] == Vec3f(0, 10, 0);
    const Vec4f expected = last ? Vec4f(1, 0, 0, 1) : Vec4f(0, 1, 0, -1);
    EXPECT_EQ((*primitive.tangents)[v], expected) << v;
  }
  for (const char* none : {"0,0,0", "nan,0,0"}) {
    sample.last_tangent = none;
    const auto without = read_or_fail(folder.add("without.fbx", sample.text()));
    EXPECT_FALSE(without.meshes[0].primitives[0].tangents) << none;
    EXPECT_TRUE(has_code(without.diagnostics, "assimp-tangents")) << none;
    EXPECT_EQ(without.meshes[0].primitives[0].vertex_count(), 4u);
  }
  EXPECT_FALSE(
      read_or_fail(folder.add("a.dae", collada(MovingRig()))).meshes[0].primitives[0].tangents);
}

TEST(Fbx, SpaceAndMesh) {
  const FbxSample sample;
  const Folder folder;
  const auto scene = read_or_fail(folder.add("body.fbx", sample.text()));
  EXPECT_EQ(scene.space.metres, 0.0254);
  ASSERT_TRUE(scene.space.file_to_krok);
  // Z is up and the figure looks along -Y.
  EXPECT_LT((*scene.space.file_to_krok * Vec3::UnitZ() - Vec3::UnitY()).norm(), 1e-12);
  EXPECT_LT((*scene.space.file_to_krok * Vec3(0, -1, 0) - Vec3::UnitZ()).norm(), 1e-12);
  ASSERT_EQ(scene.meshes.size(), 1u);
  const nodes::Primitive& primitive = scene.meshes[0].primitives[0];
  EXPECT_EQ(primitive.vertex_count(), 4u) << "corners of a square are shared by its triangles";
  EXPECT_EQ(primitive.triangles.size(), 2u);
  ASSERT_EQ(primitive.targets.size(), 1u);
  Vec3f sum = Vec3f::Zero();
  for (const Vec3f& moved : *primitive.targets[0].positions) sum += moved;
  EXPECT_LT((sum - Vec3f(0, 0, 2)).norm(), 1e-5f);
  // At rest the mesh is as it was bound.
  const auto state = evaluate(scene, -1, 0);
  ASSERT_EQ(state.positions.size(), 1u);
  for (const Vec3& position : state.positions[0]) EXPECT_NEAR(position[2], 0.0, 1e-3);
}

}  // namespace
}  // namespace krok
