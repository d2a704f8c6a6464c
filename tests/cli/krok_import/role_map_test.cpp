// If these fail, krok-import does not heed what the user says of joints, works out axes from roles
// that the user put right, or does not tell what it takes the joints for.

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/krok_import/imported.h"
#include "formats/bvh/bvh_writer.h"
#include "support/glb_builder.h"
#include "support/human_skeleton.h"
#include "unit/acclaim/small_files.h"

namespace krok::test {
namespace {

using Json = nlohmann::ordered_json;

class RoleMapImport : public CliTest {
 protected:
  // A person whose left and right side have each other's names, so that by the names it faces -Z,
  // and who holds a thing that has no role; and a map that puts the sides right.
  void put_exchanged_sides() const {
    Clip clip;
    clip.skeleton = human_skeleton();
    clip.skeleton.add("Gizmo", clip.skeleton.find("Hips"), {Vec3(0, 1, 0.3)});
    for (std::string& name : clip.skeleton.names) {
      if (name.starts_with("Left")) {
        name.replace(0, 4, "Right");
      } else if (name.starts_with("Right")) {
        name.replace(0, 5, "Left");
      }
    }
    clip.resize(4);
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      clip.set_pose(frame, clip.skeleton.reference);
    }
    auto file = OutputFile::create(path("walk.bvh"), {});
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(bvh::write(clip, {}, *file).ok());
    ASSERT_TRUE(file->commit().ok());
    take_mark_from("walk.bvh");

    Json joints = Json::object();
    const std::pair<const char*, const char*> parts[] = {
        {"Shoulder", "collar"}, {"Arm", "upper_arm"},   {"ForeArm", "lower_arm"},
        {"Hand", "hand"},       {"UpLeg", "upper_leg"}, {"Leg", "lower_leg"},
        {"Foot", "foot"},       {"ToeBase", "toes"}};
    for (const auto& [joint, role] : parts) {
      joints[std::string("Left") + joint] = std::string("right_") + role;
      joints[std::string("Right") + joint] = std::string("left_") + role;
    }
    put("sides.json", Json{{"joints", joints}}.dump());
  }

  Json result_of(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"-o", path("out.anim"), "--json"});
    const ToolRun run = run_tool("krok-import", arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.exit_code == 0 ? Json::parse(run.out)["result"] : Json();
  }
};

TEST_F(RoleMapImport, WithoutAMapTheReportTellsWhatNamesTell) {
  put_exchanged_sides();
  const Json result = result_of({path("walk.bvh")});
  EXPECT_EQ(result["humanoid"], true);
  EXPECT_EQ(result["roles"]["hips"], "Hips");
  EXPECT_EQ(result["roles"]["spine"], (Json{"Spine", "Spine1"}));
  EXPECT_EQ(result["roles"]["left_hand"], "LeftHand");
  EXPECT_EQ(result["missing_roles"], Json::array());
  EXPECT_EQ(result["unknown_joints"], Json{"Gizmo"});
  EXPECT_EQ(result["given_roles"], Json::object());
  EXPECT_EQ(result["forward"]["choice"], "-z");
  EXPECT_EQ(result["forward"]["confidence"], "guess");  // the toes point the other way
}

TEST_F(RoleMapImport, AMapOverridesTheRolesAndWithThemTheAxes) {
  put_exchanged_sides();
  // In blocks, and as a whole.
  using Words = std::vector<std::string>;
  for (const Words& more : {Words(), Words{"--rate", "60"}}) {
    std::vector<std::string> arguments = {path("walk.bvh"), "--map", path("sides.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Json result = result_of(arguments);
    EXPECT_EQ(result["roles"]["left_hand"], "RightHand");
    EXPECT_EQ(result["given_roles"].size(), 16u);
    EXPECT_EQ(result["given_roles"]["RightHand"], "left_hand");
    EXPECT_EQ(result["forward"]["choice"], "z");
    EXPECT_EQ(result["forward"]["confidence"], "certain");
  }
  const Clip clip =
      imported_clip({path("walk.bvh"), "--map", path("sides.json")}, path("out.anim"));
  const auto toes = static_cast<std::size_t>(clip.skeleton.find("RightToeBase"));
  EXPECT_GT(clip.skeleton.reference[toes].position.z(), 0.05) << "it faces +Z";
  EXPECT_GT(clip.skeleton.reference[toes].position.x(), 0) << "its left is +X";
  ASSERT_EQ(clip.provenance.sources.size(), 2u);
  EXPECT_EQ(clip.provenance.sources[1].name, "sides.json");
  EXPECT_EQ(clip.provenance.options[0], (std::pair<std::string, std::string>{"map", "sides.json"}));
}

TEST_F(RoleMapImport, VerboseShowsTheRoles) {
  put_exchanged_sides();
  const std::vector<std::string> plain = {path("walk.bvh"), "-o", path("out.anim")};
  EXPECT_THAT(run_tool("krok-import", plain).err, Not(HasSubstr("humanoid")));
  std::vector<std::string> verbose = plain;
  verbose.insert(verbose.end(), {"-v", "--map", put("m.json", R"({"joints": {"Neck": "none"}})")});
  const ToolRun run = run_tool("krok-import", verbose);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("\n  body           humanoid, 21 joints with a body role\n"));
  EXPECT_THAT(run.err, HasSubstr("\n  trunk          hips Hips, spine Spine Spine1, chest Spine2, "
                                 "head Head\n"));
  EXPECT_THAT(run.err, HasSubstr("\n  no role        2 joints: Neck Gizmo\n"));
  EXPECT_THAT(run.err, HasSubstr("\n  as given       Neck none\n"));
}

TEST_F(RoleMapImport, NamesThatATerminalWouldObeyAreShownHarmless) {
  GlbBuilder builder = rig();
  builder.json["nodes"][2]["name"] = "red\u001B[31m\u009B";
  const auto glb = builder.glb();
  put("rig.glb", std::string(reinterpret_cast<const char*>(glb.data()), glb.size()));
  const ToolRun run = run_tool("krok-import", {path("rig.glb"), "-o", path("out.anim"), "-v"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no role        2 joints: Root red?[31m?\n"));
}

TEST_F(RoleMapImport, AcclaimMotionsAndCharactersTakeOneToo) {
  put("leg.asf", small_files::kAsf);
  put("walk.amc", small_files::kAmc);
  put("hips.json", R"({"joints": {"root": "hips"}})");
  Json result = result_of({path("walk.amc"), "--map", path("hips.json")});
  EXPECT_EQ(result["given_roles"], (Json{{"root", "hips"}}));
  EXPECT_EQ(result["roles"]["hips"], "root");

  const auto glb = rig().glb();
  put("rig.glb", std::string(reinterpret_cast<const char*>(glb.data()), glb.size()));
  result = result_of({path("rig.glb")});
  EXPECT_EQ(result["unknown_joints"], (Json{"Root", "Tip"}));
  result = result_of({path("rig.glb"), "--map",
                      put("tip.json", R"({"joints": {"Tip": "head", "Root": "hips"}})")});
  EXPECT_EQ(result["roles"], (Json{{"hips", "Root"}, {"head", "Tip"}}));
  EXPECT_EQ(result["unknown_joints"], Json::array());
}

TEST_F(RoleMapImport, FaultsOfAMapAreToldWithTheirPlace) {
  put_exchanged_sides();
  const auto glb = rig().glb();
  put("rig.glb", std::string(reinterpret_cast<const char*>(glb.data()), glb.size()));
  put("leg.asf", small_files::kAsf);
  put("joint.json", "{\"joints\":\n {\"Nobody\": \"hips\"}}");
  put("role.json", "{\"joints\": {}, \"rolls\": 1}");
  for (const char* input : {"walk.bvh", "rig.glb", "leg.asf"}) {
    const ToolRun joint =
        run_tool("krok-import", {path(input), "-o", path("out.anim"), "--map", path("joint.json")});
    EXPECT_EQ(joint.exit_code, 2) << input;
    EXPECT_THAT(joint.err,
                HasSubstr("joint.json:2:3: error: the skeleton has no joint \"Nobody\""));
    EXPECT_TRUE(has_code(joint.err, "role-map-joint")) << joint.err;
    const ToolRun role =
        run_tool("krok-import", {path(input), "-o", path("out.anim"), "--map", path("role.json")});
    EXPECT_EQ(role.exit_code, 2) << input;
    EXPECT_TRUE(has_code(role.err, "role-map-shape")) << role.err;
    const ToolRun none =
        run_tool("krok-import", {path(input), "-o", path("out.anim"), "--map", path("none.json")});
    EXPECT_EQ(none.exit_code, 2) << input;
    EXPECT_TRUE(has_code(none.err, "file-missing")) << none.err;
  }
  EXPECT_FALSE(std::filesystem::exists(path("out.anim")));
}

// With all conventions given nothing is worked out from roles, and they still stand in the report.
TEST_F(RoleMapImport, GivenConventionsLeaveTheRolesInTheReport) {
  put_exchanged_sides();
  const Json result = result_of({path("walk.bvh"), "--map", path("sides.json"), "--unit", "cm",
                                 "--up", "y", "--forward", "-z"});
  EXPECT_EQ(result["forward"]["choice"], "-z");
  EXPECT_EQ(result["roles"]["left_foot"], "RightFoot");
}

TEST_F(RoleMapImport, ABatchDoesAnewWhatAChangedMapChanges) {
  put_exchanged_sides();
  const auto batch = [&] {
    const ToolRun run = run_tool("krok-import", {path("walk.bvh"), "--out-dir", path("out"),
                                                 "--map", path("sides.json"), "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return Json::parse(run.out)["files"][0];
  };
  EXPECT_EQ(batch()["result"]["roles"]["left_hand"], "RightHand");
  EXPECT_EQ(batch()["status"], "unchanged");
  put("sides.json", R"({"joints": {}})");
  const Json changed = batch();
  EXPECT_EQ(changed["status"], "done");
  EXPECT_EQ(changed["result"]["roles"]["left_hand"], "LeftHand");
}

}  // namespace
}  // namespace krok::test
