// If these fail, krok-info tells something wrong of a file, or a script that calls it cannot trust
// its exit code and its JSON.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/fixture.h"
#include "core/file.h"
#include "golden/samples/samples.h"
#include "support/human_skeleton.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

const std::string kFrozen = test::source_folder() + "/tests/golden/v1/";

struct Outcome {
  int exit_code = -1;
  std::string out, err;
};

class KrokInfo : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "krok-info-" + std::to_string(getpid());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }

  std::string make(const std::string& name, std::string_view text) const {
    EXPECT_TRUE(write_file(path(name), text).ok());
    return path(name);
  }

  Outcome run(const std::string& arguments) const {
    const std::string command = test::tools_folder() + "/krok-info " + arguments + " >'" +
                                path("out") + "' 2>'" + path("err") + "'";
    Outcome result;
    const int status = std::system(command.c_str());
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    result.out = read(path("out"));
    result.err = read(path("err"));
    return result;
  }

 private:
  static std::string read(const std::string& name) {
    const auto file = InputFile::open(name);
    return file ? std::string(file->text()) : std::string();
  }
  std::string folder_;
};

constexpr const char* kBvh =
    "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation "
    "Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 50 0\n}\n}\nMOTION\nFrames: 3\nFrame Time: 0.05\n"
    "0 90 0 0 0 0\n0 90 1 0 0 0\n0 90 2 0 0 0\n";

// Would fail if what stands elsewhere looked as if it stood at the origin.
TEST_F(KrokInfo, TellsWhereTheReferencePoseIs) {
  std::string far = kBvh;
  far.replace(far.find("OFFSET 0 0 0"), 12, "OFFSET 300 0 -400");
  const Outcome result = run(make("far.bvh", far));
  EXPECT_THAT(result.out, HasSubstr("X 3 to 3, Y 0 to 0.5, Z -4 to -4 m; 5 m from the origin"));
  const Outcome near = run(make("near.bvh", kBvh));
  EXPECT_THAT(near.out, HasSubstr("X 0 to 0, Y 0 to 0.5, Z 0 to 0 m\n"));
}

TEST_F(KrokInfo, TellsTiersOfATextGrid) {
  const Outcome result =
      run(make("talk.TextGrid",
               "File type = \"ooTextFile\"\nObject class = \"TextGrid\"\n\n0\n2\n"
               "<exists>\n1\n\"IntervalTier\"\n\"phones\"\n0\n2\n2\n0\n1\n\"\"\n1\n"
               "2\n\"AA\"\n"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("phones: 2 intervals, 1 with a label"));
}

TEST_F(KrokInfo, TellsWhatIsInAMotion) {
  const Outcome result = run(kFrozen + "motion.anim");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* text :
       {"a motion (.anim)", "2 at 29.97 frames/s", "0.03337 s", "3, 1 of them end sites",
        "0.125 x 1 x 0.3125 m (X, Y, Z; joints in the reference pose)",
        "x, y, z; w is reconstructed", "krok-import 0.1.0",
        "walk \"1\".bvh (xxh3 0123456789abcdef)", "--unit cm", "--repair", "up: z to y",
        "2 frames were cut short [bvh-frame-count]"}) {
    EXPECT_THAT(result.out, HasSubstr(text));
  }
}

TEST_F(KrokInfo, ColumnsAreAligned) {
  const std::string out = run(kFrozen + "camera.cam").out;
  EXPECT_THAT(out, HasSubstr("\n  frames         2 at"));
  EXPECT_THAT(out, HasSubstr("\n  field of view  42.97 to 50.13 deg, vertical\n"));
}

TEST_F(KrokInfo, TellsWhatIsInAModel) {
  const Outcome result = run(kFrozen + "full.model");
  EXPECT_EQ(result.exit_code, 0);
  for (const char* text :
       {"4 vertices, 2 triangles", "normals, texture coordinates, tangents", "up to 3 per vertex",
        "body, 1 triangle, material skin", "1 x 1 x 0.5 m (X, Y, Z; mesh in the reference pose)"}) {
    EXPECT_THAT(result.out, HasSubstr(text));
  }
}

TEST_F(KrokInfo, JsonHoldsTheMetrics) {
  const Outcome result =
      run("--json " + kFrozen + "motion.anim " + kFrozen + "full.model " + kFrozen + "camera.cam");
  EXPECT_EQ(result.exit_code, 0);
  const json report = json::parse(result.out);
  EXPECT_EQ(report["schema"], "krok.report/1");
  const json& files = report["result"]["files"];
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0]["kind"], "anim");
  EXPECT_EQ(files[0]["frames"], 2);
  EXPECT_EQ(files[0]["rate"], 30000.0 / 1001.0);
  EXPECT_EQ(files[0]["joints"], 3);
  EXPECT_EQ(files[0]["size"], (json{0.125, 1.0, 0.3125}));
  EXPECT_EQ(files[0]["height"], 1.0);
  EXPECT_EQ(files[0]["skeleton"][1]["parent"], "Hips");
  EXPECT_TRUE(files[0]["skeleton"][2].contains("role"));
  EXPECT_EQ(files[0]["provenance"]["tool"], "krok-import");
  EXPECT_EQ(files[1]["vertices"], 4);
  EXPECT_EQ(files[1]["influences_per_vertex"], 3);
  EXPECT_EQ(files[1]["parts"][0]["material"], "skin");
  EXPECT_NEAR(files[2]["field_of_view"]["largest"].get<double>(), 0.875 * 180 / kPi, 1e-6);
}

TEST_F(KrokInfo, TellsWhatACaptureIsTakenFor) {
  const Outcome result = run("--json " + make("walk.bvh", kBvh));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const json file = json::parse(result.out)["result"]["files"][0];
  EXPECT_EQ(file["kind"], "bvh");
  EXPECT_EQ(file["frames"], 3);
  EXPECT_EQ(file["rate"], 20);
  for (const char* key : {"unit", "up", "forward", "positions"}) {
    EXPECT_TRUE(file[key].contains("choice")) << key;
    EXPECT_TRUE(file[key].contains("confidence")) << key;
  }
}

TEST_F(KrokInfo, VerboseShowsJointsAndRoles) {
  EXPECT_THAT(run(kFrozen + "motion.anim").out, Not(HasSubstr("roles")));
  EXPECT_THAT(run("-v " + kFrozen + "motion.anim").out, HasSubstr("roles"));
  EXPECT_THAT(run("-v " + kFrozen + "motion.anim").out, HasSubstr("  Kn\xC3\xA4"
                                                                  "chel 2\n"));
}

TEST_F(KrokInfo, ShowsWhatTheJointsAre) {
  Clip clip;
  clip.skeleton = test::human_skeleton();
  clip.skeleton.add("LeftHandIndex1", clip.skeleton.find("LeftHand"), {});
  ASSERT_TRUE(write_file(path("human.anim"), samples::bytes_of(clip)).ok());
  const Outcome result = run(path("human.anim"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* text :
       {"humanoid, ", "hips Hips, spine Spine Spine1, chest Spine2, neck Neck, head Head",
        "collar LeftShoulder, upper arm LeftArm, lower arm LeftForeArm, hand LeftHand",
        "index 1 joints", "upper leg RightUpLeg, lower leg RightLeg, foot RightFoot, toes"}) {
    EXPECT_THAT(result.out, HasSubstr(text));
  }
  EXPECT_THAT(result.out, Not(HasSubstr("missing")));
  const json file = json::parse(run("--json " + path("human.anim")).out)["result"]["files"][0];
  EXPECT_EQ(file["roles"]["hips"], "Hips");
  EXPECT_EQ(file["roles"]["spine"], (json{"Spine", "Spine1"}));
  EXPECT_EQ(file["roles"]["left_index_1"], "LeftHandIndex1");
  EXPECT_EQ(file["missing_roles"], json::array());
}

TEST_F(KrokInfo, TellsWhatAHumanoidLacks) {
  const Outcome result = run("--json " + make("walk.bvh", kBvh));
  const json file = json::parse(result.out)["result"]["files"][0];
  EXPECT_EQ(file["humanoid"], false);
  EXPECT_EQ(file["missing_roles"].size(), 12u);
  EXPECT_THAT(run(path("walk.bvh")).out, HasSubstr("missing"));
}

TEST_F(KrokInfo, AMapOverridesWhatNamesSay) {
  Clip clip;
  clip.skeleton = test::human_skeleton();
  ASSERT_TRUE(write_file(path("human.anim"), samples::bytes_of(clip)).ok());
  make("map.json", "{\"joints\": {\"Spine1\": \"chest\", \"Neck\": \"none\"}}");
  const Outcome result = run(path("human.anim") + " --map " + path("map.json"));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("spine Spine Spine2, chest Spine1, head Head"));
  make("bad.json", "{\"joints\": {\"Spine1\": \"chst\"}}");
  const Outcome bad = run(path("human.anim") + " --map " + path("bad.json"));
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, HasSubstr("bad.json:1:23: error: there is no role \"chst\""));
  EXPECT_THAT(bad.err, HasSubstr("[role-map-role]"));
}

TEST_F(KrokInfo, GoesOnAfterAFileThatFails) {
  const Outcome result = run(path("none.anim") + " " + kFrozen + "motion.anim " +
                             make("hello.txt", "hello\n") + " " + kFrozen + "camera.cam");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("none.anim: error: no such file [file-missing]"));
  EXPECT_THAT(result.err, HasSubstr("hello.txt: error: is a text file of unknown kind"));
  EXPECT_THAT(result.err, HasSubstr("[info-kind]"));
  EXPECT_THAT(result.out, HasSubstr("a motion"));
  EXPECT_THAT(result.out, HasSubstr("a camera"));
}

// Many files are a table with what they are together; each in full where that is asked for.
TEST_F(KrokInfo, ManyFilesAreATable) {
  std::filesystem::create_directories(path("many"));
  for (const char* name : {"a", "b", "c", "d"}) {
    std::filesystem::copy(kFrozen + "motion.anim", path("many/" + std::string(name) + ".anim"));
  }
  std::filesystem::copy(kFrozen + "full.model", path("many/e.model"));
  const Outcome all = run(path("many"));
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_NE(all.out.find("\n\n5 files: 4 anim, 1 model\n"), std::string::npos) << all.out;
  EXPECT_EQ(std::count(all.out.begin(), all.out.end(), '\n'), 1 + 5 + 1 + 3) << all.out;
  EXPECT_NE(all.out.find("d.anim"), std::string::npos) << all.out;
  EXPECT_NE(run("-v " + path("many")).out.find("orientations"), std::string::npos);
}

TEST_F(KrokInfo, JsonTellsOfFilesThatFail) {
  const Outcome result = run("--json " + path("none.anim") + " " + kFrozen + "camera.cam");
  EXPECT_EQ(result.exit_code, 2);
  const json report = json::parse(result.out);
  EXPECT_EQ(report["result"]["files"][0]["error"], "file-missing");
  EXPECT_EQ(report["issues"][0]["severity"], "error");
  EXPECT_EQ(report["result"]["files"][1]["kind"], "cam");
}

TEST_F(KrokInfo, QuietStillTellsErrors) {
  const Outcome result = run("-q " + path("none.anim"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("no such file"));
}

TEST_F(KrokInfo, BadFilesGetAMessageAndExitCode2) {
  auto cut = samples::bytes_of(samples::clip());
  cut.resize(cut.size() / 2);
  ASSERT_TRUE(write_file(path("cut.anim"), cut).ok());
  auto damaged = samples::bytes_of(samples::clip());
  damaged[600] ^= std::byte{1};
  ASSERT_TRUE(write_file(path("damaged.anim"), damaged).ok());
  std::filesystem::create_directories(path("folder.anim"));

  const std::pair<std::string, const char*> cases[] = {
      {path("cut.anim"), "[container-truncated]"},
      {path("damaged.anim"), "[container-checksum]"},
      {path("folder.anim"), "[folder-empty]"},
      {make("empty.anim", ""), "is an empty file, not a .anim file"},
      {make("cut.bvh", "HIERARCHY\nROOT Hips\n{\n"), "cut.bvh:"},
      {make("cut.glb", "glTF\2"), "[gltf-"},
  };
  for (const auto& [file, text] : cases) {
    const Outcome result = run(file);
    EXPECT_EQ(result.exit_code, 2) << file;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_THAT(result.err, HasSubstr("error: "));
    EXPECT_EQ(result.out, "");
  }
}

TEST_F(KrokInfo, ControlCharactersDoNotReachTheTerminal) {
  Clip clip = samples::clip();
  clip.skeleton.names[0] = "\x1B[31mred\x07\xC2\x9Bx";
  ASSERT_TRUE(write_file(path("odd.anim"), samples::bytes_of(clip)).ok());
  const Outcome result = run("-v " + path("odd.anim"));
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("?[31mred??x"));
  EXPECT_THAT(result.out, Not(HasSubstr("\x1B")));
}

TEST_F(KrokInfo, ReadsStandardInput) {
  const Outcome result = run("- <" + kFrozen + "camera.cam");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("a camera"));
}

TEST_F(KrokInfo, UsageErrors) {
  EXPECT_EQ(run("").exit_code, 2);
  EXPECT_EQ(run("--nonsense " + kFrozen + "camera.cam").exit_code, 2);
  const Outcome help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("Usage: krok-info [options] FILE..."));
}

}  // namespace
}  // namespace krok::test
