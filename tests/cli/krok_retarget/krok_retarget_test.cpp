// If these fail, krok-retarget writes another motion than its library makes, or its user is not
// told which joint went where and what went wrong.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/motion_fixture.h"
#include "core/file.h"
#include "core/index.h"
#include "formats/anim/anim.h"
#include "formats/model/model_format.h"
#include "math/quaternion.h"
#include "roles/roles.h"
#include "samples/generator/walk.h"
#include "support/glb_builder.h"
#include "support/human_skeleton.h"
#include "support/skeleton_text.h"
#include "support/test_scenes.h"
#include "support/this_build.h"

namespace krok::test {
namespace {

class KrokRetarget : public MotionTest {
 protected:
  void SetUp() override {
    samples::WalkOptions options;
    options.steps = 2;
    options.rate = 30;
    walk_ = samples::make_walk(options)->clip;
    write("walk.anim", walk_);
  }

  using MotionTest::write;
  void write(const std::string& name, const Model& model) const {
    auto file = OutputFile::create(path(name));
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(model::write(model, {}, *file).ok());
    ASSERT_TRUE(file->commit().ok());
  }

  ToolRun retarget(std::vector<std::string> arguments) const {
    return run_here("krok-retarget", std::move(arguments));
  }

  // The actor of the walk under names that say nothing, with so many things on its belt that its
  // shape does not tell either.
  static Skeleton nameless(const Skeleton& from) {
    Skeleton skeleton = from;
    for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
      skeleton.names[j] = "n" + std::to_string(j);
    }
    for (int i = 0; i < 9; ++i) skeleton.add("m" + std::to_string(i), 0, from.reference[0]);
    return skeleton;
  }

  Clip walk_;
};

// Takes of a folder would be left out, and a character would have to be imported first.
TEST_F(KrokRetarget, TakesAndTargetMayBeScenes) {
  std::filesystem::create_directory(path("takes"));
  ASSERT_EQ(run_here("krok-export", {"walk.anim", "-o", "takes/walk.glb"}).exit_code, 0);
  GlbBuilder prop = rig();
  prop.json.erase("animations");
  const auto bytes = prop.glb();
  put("takes/prop.glb", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const ToolRun run = retarget({"takes", "--onto", "takes/walk.glb", "--out-dir", "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("prop.glb: warning: the file has no animation: it is left out"));
  EXPECT_THAT(run.err, HasSubstr("krok-retarget: 2 files, 1 done, 1 left out"));
  const Clip clip = read("out/walk.anim");
  EXPECT_EQ(clip.skeleton.names, walk_.skeleton.names);
  EXPECT_EQ(clip.frame_count(), walk_.frame_count());
}

// Would fail if a motion and a body in the wrong order gave a still without a word.
TEST_F(KrokRetarget, AStillOntoAMotionIsWarnedOf) {
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--to", "0f", "-o", "still.anim"}).exit_code, 0);
  const ToolRun swapped = retarget({"still.anim", "--onto", "walk.anim", "-o", "out.anim"});
  EXPECT_EQ(swapped.exit_code, 0);
  EXPECT_THAT(swapped.err, HasSubstr("[retarget-still]"));
  const ToolRun meant = retarget({"walk.anim", "--onto", "still.anim", "-o", "out.anim"});
  EXPECT_THAT(meant.err, Not(HasSubstr("[retarget-still]")));
}

TEST_F(KrokRetarget, OntoItsOwnSkeletonAMotionComesBack) {
  const auto run = retarget({"walk.anim", "--onto", "walk.anim", "-o", "out.anim"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("mapped by same skeleton, scale 1"));
  const Clip before = read("walk.anim");
  const Clip after = read("out.anim");
  EXPECT_EQ(after.rate, before.rate);
  ASSERT_EQ(after.positions.size(), before.positions.size());
  for (std::size_t i = 0; i < after.positions.size(); ++i) {
    ASSERT_EQ(after.positions[i], before.positions[i]);
    ASSERT_EQ(after.orientations[i].coeffs(), before.orientations[i].coeffs());
  }
}

TEST_F(KrokRetarget, OntoAModelItTellsWhatItDid) {
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  const auto run = retarget({"walk.anim", "--onto", "hero.model", "-o", "out.anim", "-v"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  for (const char* text : {"out.anim: ", "mapped by roles, scale 0.6", "feet corrected by up to ",
                           "left_upper_arm", "LeftForeArm"}) {
    EXPECT_THAT(run.err, HasSubstr(text));
  }
  const Clip clip = read("out.anim");
  EXPECT_EQ(clip.skeleton.names, test::human_skeleton().names);
  EXPECT_EQ(clip.frame_count(), walk_.frame_count());
  EXPECT_EQ(clip.provenance.tool, "krok-retarget");
  ASSERT_EQ(clip.provenance.sources.size(), 2u);
  EXPECT_EQ(clip.provenance.sources[1].name, "hero.model");
}

// One command in place of two would show another motion, or a folder with one bad take nothing.
TEST_F(KrokRetarget, SkinningMovesMotionsToTheMeshAlike) {
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  retarget({"walk.anim", "--onto", "hero.model", "-o", "moved.anim"});
  ASSERT_EQ(
      run_here("krok-skin", {"hero.model", "walk=moved.anim", "-o", "two_steps.glb"}).exit_code, 0);
  std::filesystem::create_directory(path("takes"));
  std::filesystem::copy(path("walk.anim"), path("takes/walk.anim"));
  const std::vector<std::string> arguments = {"hero.model", "takes", "-o", "one_step.glb"};
  const auto skin = [&](std::vector<std::string> further) {
    further.insert(further.begin(), arguments.begin(), arguments.end());
    return run_here("krok-skin", std::move(further));
  };
  const ToolRun other = skin({});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("krok-skin --retarget"));
  ASSERT_EQ(skin({"--retarget"}).exit_code, 0);
  const ToolRun same = run_here("krok-diff", {"two_steps.glb", "one_step.glb"});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;

  put("takes/a_bad_one.bvh", "HIERARCHY nothing");
  const ToolRun bad = skin({"--retarget"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, HasSubstr("--keep-going leaves it out"));
  const ToolRun kept = skin({"--retarget", "--keep-going"});
  EXPECT_EQ(kept.exit_code, 3);
  EXPECT_THAT(kept.err, AllOf(HasSubstr("a_bad_one.bvh:1:11: warning"), HasSubstr("left out")));
  EXPECT_EQ(run_here("krok-diff", {"two_steps.glb", "one_step.glb"}).exit_code, 0);
}

TEST_F(KrokRetarget, TheReportHoldsTheSame) {
  Clip target;
  target.skeleton = test::human_skeleton(2);
  target.skeleton.names[1] = "Lumbar";
  target.skeleton.add("Tail", 0, {});
  write("target.anim", target);
  const auto run = retarget({"walk.anim", "--onto", "target.anim", "-o", "out.anim", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json result = json::parse(run.out)["result"];
  EXPECT_EQ(result["method"], "roles");
  EXPECT_NEAR(result["scale"].get<double>(), 2 / 1.75, 0.02);
  EXPECT_EQ(result["following"], json{"Tail"});
  EXPECT_GE(result["feet"]["left"]["largest_correction"].get<double>(), 0);
  bool found = false;
  for (const json& joint : result["joints"]) {
    if (joint["joint"] != "LeftHand") continue;
    found = true;
    EXPECT_EQ(joint["role"], "left_hand");
    EXPECT_EQ(joint["from"], "LeftHand");
  }
  EXPECT_TRUE(found);
}

// Without them nobody would notice feet that slide or hands that part.
TEST_F(KrokRetarget, EveryContactIsReported) {
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  const auto run = retarget({"walk.anim", "--onto", "hero.model", "-o", "out.anim", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json contacts = json::parse(run.out)["result"]["contacts"];
  bool left_heel = false;
  for (const json& contact : contacts) {
    EXPECT_LT(contact["start"].get<double>(), contact["end"].get<double>());
    if (contact["on"] != "ground") continue;
    EXPECT_LT(contact["slide"].get<double>(), contact["input_slide"].get<double>() + 0.1);
    EXPECT_LT(contact["height_off"].get<double>(), 0.02);
    left_heel = left_heel || contact["part"] == "left heel";
  }
  EXPECT_TRUE(left_heel);
  const auto free = retarget(
      {"walk.anim", "--onto", "hero.model", "-o", "free.anim", "--touches", "free", "--json"});
  ASSERT_EQ(free.exit_code, 0) << free.err;
  EXPECT_TRUE(json::parse(free.out)["result"]["contacts"].empty());
}

// Would fail if contacts that limbs do not reach were a number in the last line alone.
TEST_F(KrokRetarget, MissedContactsAreWarnedOf) {
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  std::vector<std::string> arguments = {"walk.anim", "--onto", "hero.model", "-o", "out.anim"};
  EXPECT_EQ(retarget(arguments).err.find("retarget-contact"), std::string::npos);
  arguments.insert(arguments.end(), {"--scale", "1.5"});
  const auto run = retarget(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("contacts missed; worst: "));
  EXPECT_THAT(run.err, HasSubstr("[retarget-contact]"));
  // Would fail if it blamed proportions, which are the walker's.
  EXPECT_THAT(run.err, testing::ContainsRegex("worst: (left|right) [a-z]+ .(Left|Right)[A-Za-z]+. "
                                              "on ground.* slides [0-9]+ mm/s .the input's"));
  EXPECT_THAT(run.err, HasSubstr("hint: lengths are scaled by 1.5, legs are 0.6"));
  // Of a doll, which is 5 cm off nowhere, too.
  write("doll.model", test::tube_model(test::human_skeleton(0.12)));
  const auto doll =
      retarget({"walk.anim", "--onto", "doll.model", "-o", "out.anim", "--scale", "0.15"});
  EXPECT_THAT(doll.err, HasSubstr("[retarget-contact]"));
}

// Would fail if hands of long arms went into the ground without a word.
TEST_F(KrokRetarget, HandsInTheGroundAreWarnedOf) {
  Skeleton ape = test::human_skeleton(1.6);
  for (std::size_t j = 0; j < ape.names.size(); ++j) {
    Vec3& place = ape.reference[j].position;
    if (ape.names[j].find("Hand") != std::string::npos) place.x() *= 2.4;
  }
  write("ape.model", test::tube_model(ape));
  const auto run = retarget({"walk.anim", "--onto", "ape.model", "-o", "out.anim"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err,
              testing::ContainsRegex("Hand.* goes .* deeper into the ground .*retarget-sunk"));
}

// The alignment of one take for another whose own would be another: each joint keeps the same
// offset from its source in both, and what was saved gives the same bytes for the take itself.
// A dog would become a person who stoops, without a word.
TEST_F(KrokRetarget, FourLeggedInputsAreWarnedOf) {
  std::string joints, values;
  const auto joint = [&](const char* name, const char* offset) {
    joints += fmt::format("JOINT {} {{ OFFSET {} CHANNELS 3 Zrotation Xrotation Yrotation\n", name,
                          offset);
    values += " 0 0 0";
  };
  const auto end = [&](const char* offset, int depth) {
    joints += fmt::format("End Site {{ OFFSET {} }}\n", offset) + std::string(depth, '}');
  };
  joint("Spine", "0 0 40"), joint("Neck", "0 0 40"), joint("Head", "0 15 20");
  end("0 5 20", 2);  // the chest stays open
  for (const std::string side : {"Left", "Right"}) {
    joint((side + "Arm").c_str(), side == "Left" ? "10 -5 35" : "-10 -5 35");
    joint((side + "ForeArm").c_str(), "0 -20 0");
    joint((side + "Hand").c_str(), "0 -20 0");
    end("0 -2 8", 3);
  }
  joints += "}";
  for (const std::string side : {"Left", "Right"}) {
    joint((side + "UpLeg").c_str(), side == "Left" ? "10 -5 0" : "-10 -5 0");
    joint((side + "Leg").c_str(), "0 -20 0");
    joint((side + "Foot").c_str(), "0 -20 0");
    end("0 -2 8", 3);
  }
  put("dog.bvh",
      "HIERARCHY\nROOT Hips { OFFSET 0 0 0 CHANNELS 6 Xposition Yposition Zposition "
      "Zrotation Xrotation Yrotation\n" +
          joints + "}\nMOTION\nFrames: 2\nFrame Time: 0.0333333\n0 47 0 0 0 0" + values +
          "\n1 47 0 0 0 0" + values + "\n");
  const ToolRun run = run_here("krok-retarget", {"dog.bvh", "--onto", "walk.anim", "-o", "a.anim"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("[retarget-body]"));
  const ToolRun same =
      run_here("krok-retarget", {"walk.anim", "--onto", "dog.bvh", "-o", "b.anim"});
  EXPECT_THAT(same.err, Not(HasSubstr("[retarget-body]")));
}

TEST_F(KrokRetarget, ASavedAlignmentIsThatOfTheTake) {
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  const std::vector<std::string> first = {"walk.anim", "--onto",           "hero.model",  "--feet",
                                          "free",      "--reference-pose", "walk.anim:7", "-o"};
  auto arguments = first;
  arguments.insert(arguments.end(), {"saved.anim", "--save-alignment", "pair.json"});
  const auto saved = retarget(arguments);
  ASSERT_EQ(saved.exit_code, 0) << saved.err;
  const auto again = retarget({"walk.anim", "--onto", "hero.model", "--feet", "free", "--alignment",
                               "pair.json", "-o", "again.anim"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  Clip other = walk_;
  for (Quatf& q : other.orientations) q = Quatf(Eigen::AngleAxisf(0.7f, Vec3f::UnitY())) * q;
  write("other.anim", other);
  ASSERT_EQ(retarget({"other.anim", "--onto", "hero.model", "--feet", "free", "--alignment",
                      "pair.json", "-o", "turned.anim"})
                .exit_code,
            0);
  const Clip one = read("saved.anim"), two = read("again.anim"), turned = read("turned.anim");
  ASSERT_EQ(one.positions.size(), two.positions.size());
  for (std::size_t i = 0; i < one.positions.size(); ++i) {
    ASSERT_EQ(one.positions[i], two.positions[i]);
    ASSERT_EQ(one.orientations[i].coeffs(), two.orientations[i].coeffs());
  }
  const auto hand = static_cast<std::size_t>(one.skeleton.find("LeftHand"));
  const Quatf offset = walk_.orientations[hand].conjugate() * one.orientations[hand];
  const Quatf other_offset = other.orientations[hand].conjugate() * turned.orientations[hand];
  EXPECT_LT(offset.angularDistance(other_offset), 1e-3f);
  // Of other skeletons, or beside another pose, it is refused.
  Clip stranger;
  stranger.skeleton = test::human_skeleton();
  stranger.skeleton.names[3] = "Thorax";
  write("stranger.anim", stranger);
  const auto wrong = retarget(
      {"walk.anim", "--onto", "stranger.anim", "--alignment", "pair.json", "-o", "x.anim"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("[alignment-joint]"));
  EXPECT_THAT(wrong.err, HasSubstr("pair.json:"));
  EXPECT_EQ(retarget({"walk.anim", "--onto", "hero.model", "--alignment", "pair.json",
                      "--reference-pose", "3", "-o", "x.anim"})
                .exit_code,
            2);
  EXPECT_FALSE(std::filesystem::exists(path("x.anim")));
}

// A take on tiptoe alone does not show how a foot stands, the walk does. If this fails, takes of an
// actor come out with different feet, or a folder with another actor's takes cannot be given.
TEST_F(KrokRetarget, TakesOfAnActorAreAlignedByAllOfThem) {
  const RoleMap roles = find_roles(walk_.skeleton);
  // A reference pose that does not stand.
  for (std::size_t j = 0; j < walk_.skeleton.names.size(); ++j) {
    Vec3& p = walk_.skeleton.reference[j].position;
    if (p.y() < 0.9) p.y() = 1.8 - p.y();
  }
  Clip tiptoe = walk_;
  std::vector<Transform> pose(walk_.skeleton.names.size());
  for (int f = 0; f < tiptoe.frame_count(); ++f) {
    tiptoe.get_pose(f, pose);
    double sunk = 0;
    for (const Role role : {Role::left_foot, Role::right_foot}) {
      const auto foot = at(roles.joint(role));
      const Quat down = from_rotation_vector(0.4 * (pose[foot].orientation * Vec3::UnitX()));
      std::vector<char> inside(pose.size(), 0);
      for (std::size_t j = foot; j < pose.size(); ++j) {
        const int parent = tiptoe.skeleton.parents[j];
        inside[j] = j == foot || inside[at(parent)] != 0 ? 1 : 0;
        if (inside[j] == 0) continue;
        const double before = pose[j].position.y();
        pose[j] = {pose[foot].position + down * (pose[j].position - pose[foot].position),
                   down * pose[j].orientation};
        sunk = std::max(sunk, before - pose[j].position.y());
      }
    }
    for (Transform& joint : pose) joint.position.y() += sunk;
    tiptoe.set_pose(f, pose);
  }
  std::filesystem::create_directory(path("takes"));
  write("takes/walk.anim", walk_);
  write("takes/tiptoe.anim", tiptoe);
  Clip stranger = walk_;
  stranger.skeleton.names[2] = "Thorax";
  write("takes/stranger.anim", stranger);
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  const auto foot_of = [&](const std::string& name, const Clip& take,
                           std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"takes/" + name + ".anim", "--onto", "hero.model",
                                         "--feet", "free", "-o", name + ".anim"});
    const auto run = retarget(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const Clip made = read(name + ".anim");
    const auto foot = at(roles.joint(Role::left_foot));
    return Quatf(take.frame_orientations(0)[foot].conjugate() *
                 made.frame_orientations(0)[at(made.skeleton.find("LeftFoot"))]);
  };
  const float apart = 0.1f;
  EXPECT_GT(foot_of("walk", walk_, {}).angularDistance(foot_of("tiptoe", tiptoe, {})), apart);
  const auto saved = retarget({"takes/tiptoe.anim", "--onto", "hero.model", "--takes", "takes",
                               "--save-alignment", "pair.json"});
  ASSERT_EQ(saved.exit_code, 0) << saved.err;
  EXPECT_THAT(saved.err, HasSubstr("1 of 3 takes have another skeleton and are left out, first "
                                   "takes/stranger.anim: "));
  const std::vector<std::string> pair = {"--alignment", "pair.json"};
  const Quatf by_all = foot_of("walk", walk_, pair);
  EXPECT_LT(by_all.angularDistance(foot_of("tiptoe", tiptoe, pair)), 1e-3f);
  EXPECT_LT(by_all.angularDistance(foot_of("walk", walk_, {})), 0.05f);
  // Without the file it is the same pose.
  const Quatf by_pattern = foot_of("tiptoe", tiptoe, {"--takes", "takes/[tw]*.anim"});
  EXPECT_LT(by_all.angularDistance(by_pattern), 0.05f);

  const auto batch =
      retarget({"takes", "--onto", "hero.model", "--takes", "takes", "--out-dir", "o"});
  EXPECT_EQ(batch.exit_code, 2);
  EXPECT_THAT(batch.err, HasSubstr("--save-alignment first"));
  const auto nothing = retarget({"takes/walk.anim", "--onto", "hero.model", "--takes", "takes"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("no output given"));
  const auto none =
      retarget({"takes/walk.anim", "--onto", "hero.model", "--takes", "no/*.anim", "-o", "x.anim"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("--takes: no file there"));
}

TEST_F(KrokRetarget, FeetCanBeLeftFree) {
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  const auto run =
      retarget({"walk.anim", "--onto", "hero.model", "--feet", "free", "-o", "out.anim", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(json::parse(run.out)["result"]["feet"]["left"].is_null());
  EXPECT_EQ(
      retarget({"walk.anim", "--onto", "hero.model", "--feet", "maybe", "-o", "x.anim"}).exit_code,
      2);
}

TEST_F(KrokRetarget, AMapTellsWhatTheJointsAre) {
  Clip target;
  target.skeleton = nameless(walk_.skeleton);
  // A skirt of many joints, so that its shape is not a person's.
  const int hips = walk_.skeleton.find("Hips");
  for (int i = 0; i < 20; ++i) {
    target.skeleton.add("skirt" + std::to_string(i), hips, target.skeleton.reference[at(hips)]);
  }
  write("target.anim", target);
  const auto without = retarget({"walk.anim", "--onto", "target.anim", "-o", "out.anim"});
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("the target lacks "));
  EXPECT_THAT(without.err, HasSubstr("[retarget-roles]"));
  EXPECT_FALSE(std::filesystem::exists(path("out.anim")));

  const std::pair<const char*, const char*> roles[] = {{"Hips", "hips"},
                                                       {"Head", "head"},
                                                       {"LeftArm", "left_upper_arm"},
                                                       {"LeftHand", "left_hand"},
                                                       {"RightArm", "right_upper_arm"},
                                                       {"RightHand", "right_hand"},
                                                       {"LeftUpLeg", "left_upper_leg"},
                                                       {"LeftFoot", "left_foot"},
                                                       {"RightUpLeg", "right_upper_leg"},
                                                       {"RightFoot", "right_foot"}};
  json map;
  for (const auto& [joint, role] : roles) {
    map["joints"]["n" + std::to_string(walk_.skeleton.find(joint))] = role;
  }
  put("map.json", map.dump());
  const auto run =
      retarget({"walk.anim", "--onto", "target.anim", "--onto-map", "map.json", "-o", "out.anim"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("mapped by roles"));
  const Clip clip = read("out.anim");
  const auto hand = at(walk_.skeleton.find("LeftHand"));
  EXPECT_LT((clip.frame_positions(9)[hand] - walk_.frame_positions(9)[hand]).norm(), 1e-4);

  test::ToolOptions here;
  here.folder = folder_.string();
  const auto info =
      test::run_tool("krok-info", {"target.anim", "--map", "map.json", "--json"}, here);
  ASSERT_EQ(info.exit_code, 0) << info.err;
  EXPECT_TRUE(json::parse(info.out)["result"]["files"][0]["humanoid"].get<bool>());
}

// Would fail if feet that are turned by a wrong role went out without a word.
TEST_F(KrokRetarget, FeetTurnedByAWrongRoleAreTold) {
  Clip target;
  target.skeleton = walk_.skeleton;
  Transform beside = target.skeleton.reference[at(target.skeleton.find("LeftFoot"))];
  beside.position.x() += 0.3;
  target.skeleton.add("Buckle", target.skeleton.find("LeftFoot"), beside);
  target.skeleton.reference.back().position.z() += 0.05;
  write("target.anim", target);
  const auto plain = retarget({"walk.anim", "--onto", "target.anim", "-o", "out.anim"});
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_EQ(plain.err.find("retarget-foot"), std::string::npos) << plain.err;
  put("map.json", R"({"joints": {"Buckle": "left_toes"}})");
  const auto turned =
      retarget({"walk.anim", "--onto", "target.anim", "--onto-map", "map.json", "-o", "out.anim"});
  EXPECT_THAT(turned.err, HasSubstr("LeftFoot is turned by"));
  EXPECT_EQ(turned.err.find("RightFoot is turned"), std::string::npos) << turned.err;
}

TEST_F(KrokRetarget, AFaultyMapIsToldWithItsPlace) {
  put("map.json", "{\"joints\": {\n  \"LeftHandd\": \"left_hand\"\n}}");
  const auto run =
      retarget({"walk.anim", "--map", "map.json", "--onto", "walk.anim", "-o", "out.anim"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("map.json:2:3: error: the skeleton has no joint \"LeftHandd\""));
  EXPECT_THAT(run.err, HasSubstr("did you mean \"LeftHand\"?"));
}

// A reference pose may come from another motion of the skeleton: frame 9 of the walk by its number
// and out of a file that has it alone give the same bytes.
TEST_F(KrokRetarget, TheReferencePoseMayComeFromAnotherMotion) {
  Clip still = walk_;
  std::vector<Transform> pose(walk_.skeleton.names.size());
  walk_.get_pose(9, pose);
  still.resize(1);
  still.set_pose(0, pose);
  write("still.anim", still);
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  for (const auto& [how, out] : {std::pair("9", "a.anim"), std::pair("still.anim:0", "b.anim")}) {
    const auto run =
        retarget({"walk.anim", "--onto", "hero.model", "--reference-pose", how, "-o", out});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  const Clip a = read("a.anim"), b = read("b.anim");
  EXPECT_EQ(a.positions, b.positions);
  for (const char* wrong : {"still.anim:1", "none.anim:0", "still.anim:x"}) {
    EXPECT_EQ(
        retarget({"walk.anim", "--onto", "hero.model", "--reference-pose", wrong, "-o", "c.anim"})
            .exit_code,
        2)
        << wrong;
  }
}

TEST_F(KrokRetarget, WrongKindsOfFilesAreRefused) {
  put("text.bvh", "HIERARCHY\n");
  put("walk.cam", "KROKCAMR");
  const auto target = retarget({"walk.anim", "--onto", "walk.cam", "-o", "out.anim"});
  EXPECT_EQ(target.exit_code, 2);
  EXPECT_THAT(target.err, HasSubstr("walk.cam: error: "));
  EXPECT_THAT(target.err, HasSubstr("a Krok camera (.cam)"));
  const auto name = retarget({"walk.anim", "--onto", "walk.anim", "-o", "out.model"});
  EXPECT_EQ(name.exit_code, 2);
  const auto none = retarget({"walk.anim", "--onto", "none.model", "-o", "out.anim"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("none.model: error: no such file"));
  for (const auto& [option, value] :
       {std::pair("--scale", "0"), std::pair("--scale", "1.5x"), std::pair("--reference-pose", "T"),
        std::pair("--reference-pose", "99999")}) {
    const auto run =
        retarget({"walk.anim", "--onto", "walk.anim", option, value, "-o", "out.anim"});
    EXPECT_EQ(run.exit_code, 2) << option << value;
    EXPECT_THAT(run.err, HasSubstr("error: "));
  }
  EXPECT_FALSE(std::filesystem::exists(path("out.anim")));
}

TEST_F(KrokRetarget, ASecondRunGivesTheSameBytesWhateverTheThreads) {
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  ASSERT_EQ(retarget({"walk.anim", "--onto", "hero.model", "-j", "1", "-o", "a.anim"}).exit_code,
            0);
  ASSERT_EQ(retarget({"walk.anim", "--onto", "hero.model", "-j", "3", "-o", "b.anim"}).exit_code,
            0);
  EXPECT_EQ(get(path("a.anim")), get(path("b.anim")));
}

TEST_F(KrokRetarget, CapturesAreTakenAsTheyAre) {
  const std::string capture = test::source_folder() + "/samples/captures/walk.bvh";
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  const auto run = retarget({capture, "--onto", "hero.model", "-o", "out.anim"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("mapped by roles"));
  const auto onto = retarget({"walk.anim", "--onto", capture, "-o", "onto.anim"});
  EXPECT_EQ(onto.exit_code, 0) << onto.err;
  EXPECT_THAT(read("out.anim").provenance.conversions.front(), HasSubstr("unit: "));
}

TEST_F(KrokRetarget, ManyMotionsGoOntoOneActor) {
  write("hero.model", test::tube_model(test::human_skeleton(1.2)));
  write("second.anim", walk_);
  const auto run =
      retarget({"walk.anim", "second.anim", "--onto", "hero.model", "--out-dir", "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(path("out/walk.anim")));
  EXPECT_TRUE(std::filesystem::exists(path("out/second.anim")));
}

}  // namespace
}  // namespace krok::test
