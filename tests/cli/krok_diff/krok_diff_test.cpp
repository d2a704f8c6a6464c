// If these fail, scripts and people are told wrongly whether two files are the same.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

#include "cli/fixture.h"
#include "core/file.h"
#include "formats/anim/anim.h"
#include "math/quaternion.h"
#include "support/glb_builder.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

class KrokDiff : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("krok_diff_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Runs the tool in the test's folder.
  Outcome run(const std::string& arguments) {
    const std::string command = "cd '" + folder_.string() + "' && '" + test::tools_folder() +
                                "/krok-diff' " + arguments + " > out.txt 2> err.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of("out.txt"), text_of("err.txt")};
  }

  std::string text_of(const char* name) {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  void write(const char* name, const test::GlbBuilder& builder) {
    const auto bytes = builder.glb();
    ASSERT_TRUE(write_file((folder_ / name).string(), std::span<const std::byte>(bytes)).ok());
  }

  void write(const char* name, const Clip& clip) {
    auto file = OutputFile::create((folder_ / name).string());
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(anim::write(clip, {}, *file).ok());
    ASSERT_TRUE(file->commit().ok());
  }

  void write_text(const char* name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  fs::path folder_;
};

Clip two_joint_clip(int frames = 60) {
  Clip clip;
  clip.rate = 60;
  clip.skeleton.add("Hips", -1, {Vec3(0, 1, 0), Quat::Identity()});
  clip.skeleton.add("LeftHand", 0, {Vec3(0.5, 1.2, 0), Quat::Identity()});
  clip.resize(frames);
  for (int f = 0; f < frames; ++f) {
    std::vector<Transform> pose = clip.skeleton.reference;
    for (Transform& joint : pose) joint.orientation = from_rotation_vector(Vec3(0, 0.01 * f, 0));
    clip.set_pose(f, pose);
  }
  return clip;
}

TEST_F(KrokDiff, IdenticalFilesAreTheSame) {
  write("a.anim", two_joint_clip());
  write("b.anim", two_joint_clip());
  const Outcome done = run("a.anim b.anim");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("the same within 0.01 mm, 0.01 deg"));
  EXPECT_EQ(done.err, "");
}

TEST_F(KrokDiff, SaysHowFarWhereAndWhen) {
  Clip moved = two_joint_clip();
  moved.frame_positions(37)[1].x() += 3.2e-4f;
  write("a.anim", two_joint_clip());
  write("b.anim", moved);
  const Outcome done = run("a.anim b.anim");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.out,
              HasSubstr("positions: largest 0.32 mm at joint LeftHand, frame 37 (0.6167 s)"));
  EXPECT_THAT(done.out, HasSubstr("over tolerance in 1 of 120"));
  EXPECT_THAT(done.out, HasSubstr("beyond tolerance (0.01 mm, 0.01 deg)"));
  EXPECT_EQ(run("a.anim b.anim --tolerance 0.4mm").exit_code, 0);
  EXPECT_EQ(run("a.anim b.anim --tolerance 0.3mm").exit_code, 1);
  const Outcome quiet = run("-q a.anim b.anim");
  EXPECT_EQ(quiet.exit_code, 1);
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(KrokDiff, AnAngleHasItsOwnTolerance) {
  Clip turned = two_joint_clip();
  Quatf& q = turned.frame_orientations(5)[0];
  q = (from_rotation_vector(Vec3(0, 0, 0.5 * kRadiansPerDegree)) * q.cast<double>()).cast<float>();
  write("a.anim", two_joint_clip());
  write("b.anim", turned);
  EXPECT_EQ(run("a.anim b.anim").exit_code, 1);
  EXPECT_EQ(run("a.anim b.anim --angle 0.6deg").exit_code, 0);
}

TEST_F(KrokDiff, AnotherSkeletonOrLengthIsADifference) {
  Clip renamed = two_joint_clip();
  renamed.skeleton.names[1] = "RightHand";
  write("a.anim", two_joint_clip());
  write("b.anim", renamed);
  write("c.anim", two_joint_clip(50));
  const Outcome skeleton = run("a.anim b.anim");
  EXPECT_EQ(skeleton.exit_code, 1);
  EXPECT_THAT(skeleton.out, HasSubstr("only in the first: LeftHand"));
  const Outcome length = run("a.anim c.anim");
  EXPECT_EQ(length.exit_code, 1);
  EXPECT_THAT(length.out, HasSubstr("60 frames in the first, 50 in the second"));
  EXPECT_THAT(length.out, HasSubstr("50 frames compared"));
}

TEST_F(KrokDiff, ARigEqualsItsBakedMotion) {
  write("rig.glb", test::rig());
  write("clip.glb", test::baked_rig());
  const Outcome done = run("rig.glb clip.glb");
  EXPECT_EQ(done.exit_code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, HasSubstr("compared at 3 times"));
  EXPECT_THAT(done.out, HasSubstr("the same within"));
}

TEST_F(KrokDiff, FindsAVertexOfABakedMotion) {
  test::GlbBuilder moved = test::baked_rig();
  // The second target's displacement of corner 2, ten bytes of floats further on than its first.
  const auto& primitive = moved.json["meshes"][0]["primitives"][0];
  const auto accessor = primitive["targets"][1]["POSITION"].get<std::size_t>();
  const auto view = moved.json["accessors"][accessor]["bufferView"].get<std::size_t>();
  const auto offset = moved.json["bufferViews"][view]["byteOffset"].get<std::size_t>() + 2 * 12 + 8;
  const float z = 1e-4f;
  std::memcpy(moved.bin.data() + offset, &z, 4);
  write("rig.glb", test::rig());
  write("clip.glb", moved);
  const Outcome done = run("rig.glb clip.glb --json=report.json");
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.out,
              HasSubstr("positions: largest 0.1 mm at vertex 2 of mesh Body, frame 2 (1 s)"));
  const auto report = nlohmann::json::parse(text_of("report.json"));
  const auto& measure = report["result"]["measures"][0];
  EXPECT_EQ(report["result"]["same"], false);
  EXPECT_EQ(measure["what"], "positions");
  EXPECT_NEAR(measure["largest"].get<double>(), 1e-4, 1e-7);
  EXPECT_EQ(measure["where"]["vertex"], 2);
  EXPECT_EQ(measure["where"]["mesh"], "Body");
  EXPECT_EQ(measure["where"]["frame"], 2);
  EXPECT_EQ(measure["over"], 1);
  EXPECT_EQ(measure["count"], 12);
}

TEST_F(KrokDiff, TheOrderOfNodesDoesNotMatter) {
  test::GlbBuilder other = test::rig();
  auto& nodes = other.json["nodes"];
  std::swap(nodes[0], nodes[1]);  // Root first, then Body
  other.json["scenes"][0]["nodes"] = {0, 1};
  other.json["skins"][0]["joints"] = {0, 2};
  write("a.glb", test::rig());
  write("b.glb", other);
  const Outcome done = run("a.glb b.glb");
  EXPECT_EQ(done.exit_code, 0) << done.out << done.err;
}

TEST_F(KrokDiff, NotANumberIsTrouble) {
  test::GlbBuilder bad = test::square();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(bad.bin.data() + 4, &nan, 4);
  write("a.glb", test::square());
  write("b.glb", bad);
  const Outcome done = run("a.glb b.glb");
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(done.err, HasSubstr("b.glb: error: "));
  EXPECT_THAT(done.err, HasSubstr("[gltf-value]"));
}

TEST_F(KrokDiff, KindsThatDifferAreTrouble) {
  write("a.anim", two_joint_clip());
  write("b.glb", test::square());
  write_text("points.pc2", std::string("POINTCACHE2\0\1\0\0\0", 16) + std::string(16, '\0'));
  write_text("c.fbx", "not read here");
  const Outcome two = run("a.anim points.pc2");
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_THAT(two.err, HasSubstr("[diff-kinds]"));
  const Outcome fbx = run("a.anim c.fbx");
  EXPECT_EQ(fbx.exit_code, 2);
  EXPECT_THAT(fbx.err, HasSubstr("[diff-kind]"));
  EXPECT_THAT(fbx.err, HasSubstr("krok-import"));
  // A motion and glTF can be compared, but here they have nothing in common.
  const Outcome nothing = run("a.anim b.glb");
  EXPECT_EQ(nothing.exit_code, 1) << nothing.err;
  EXPECT_THAT(nothing.out, HasSubstr("only the first has joints (2)"));
}

TEST_F(KrokDiff, TroubleWithFilesAndOptionsIsExitCode2) {
  write("a.anim", two_joint_clip());
  write_text("empty.anim", "");
  write_text("cut.glb", "glTF\2");
  for (const char* arguments :
       {"a.anim", "a.anim missing.anim", "a.anim .", "a.anim empty.anim", "cut.glb cut.glb",
        "a.anim a.anim --tolerance 12.3abc", "a.anim a.anim --tolerance -1mm",
        "a.anim a.anim --angle 1mm", "a.anim a.anim --ratio nan", "a.anim a.anim a.anim"}) {
    const Outcome done = run(arguments);
    EXPECT_EQ(done.exit_code, 2) << arguments;
    EXPECT_THAT(done.err, HasSubstr("error: ")) << arguments;
    EXPECT_EQ(done.out, "") << arguments;
  }
}

TEST_F(KrokDiff, JsonOnStandardOutputIsAlone) {
  write("a.anim", two_joint_clip());
  const Outcome done = run("a.anim a.anim --json");
  EXPECT_EQ(done.exit_code, 0);
  const auto report = nlohmann::json::parse(done.out);
  EXPECT_EQ(report["schema"], "krok.report/1");
  EXPECT_EQ(report["result"]["same"], true);
  EXPECT_EQ(report["inputs"].size(), 2u);
}

TEST_F(KrokDiff, HelpNamesTolerancesAndExitCodes) {
  const Outcome done = run("--help");
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_THAT(done.out, HasSubstr("0.01mm"));
  EXPECT_THAT(done.out, HasSubstr("0.01deg"));
  EXPECT_THAT(done.out, Not(HasSubstr("TEXT")));
}

}  // namespace
}  // namespace krok::test
