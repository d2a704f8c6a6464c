// --game-loop: a cycle in place that an engine moves at the velocity that was taken out. Would fail
// if that velocity were not the walker's, if feet slid while the engine moves it, if the last frame
// were not the first again, or if speed and contacts were lost on the way into a glTF file.
#include <algorithm>
#include <cmath>

#include <set>

#include "cli/motion_fixture.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/travel.h"

namespace krok::test {
namespace {

class GameLoop : public MotionTest {
 protected:
  static constexpr double kRate = 60;

  // Along a heading, of two steps a second.
  void walk(const std::string& name, double heading, double turn = 0) {
    samples::WalkOptions options;
    options.cadence = 120;
    options.steps = 10;
    options.rate = kRate;
    options.turn = turn;
    Clip clip = samples::make_walk(options).value().clip;
    move_clip({Vec3(3, 0, -2), axis_rotation(Axis::y, heading)}, clip);
    write(name, clip);
  }

  json loop(const std::string& name, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {name, "--game-loop", "-o", "out.anim"});
    return report_here("krok-edit", more)["result"]["steps"];
  }

  static Vec3 at(const Clip& clip, int frame, const std::string& joint) {
    return clip.frame_positions(frame)[static_cast<std::size_t>(clip.skeleton.find(joint))]
        .cast<double>();
  }

  // An engine's arithmetic: in walking, some joint of a foot always stays. The frames in which one
  // moves by less than a distance.
  static int still_frames(const Clip& clip, double distance) {
    const RootMotion& removed = *clip.provenance.removed_root_motion;
    int still = 0;
    for (int f = 0; f + 1 < clip.frame_count(); ++f) {
      const auto in_world = [&](int frame, const std::string& joint) -> Vec3 {
        constexpr int kSteps = 100;  // of a frame
        const auto turned = [&](double frames) {
          return axis_rotation(Axis::y, removed.turn_rate * frames / kRate);
        };
        Vec3 actor = Vec3::Zero();
        for (int step = 0; step < frame * kSteps; ++step) {
          actor += turned((step + 0.5) / kSteps) * removed.velocity / (kRate * kSteps);
        }
        return actor + turned(frame) * at(clip, frame, joint);
      };
      still += std::ranges::any_of(clip.skeleton.names, [&](const std::string& joint) {
        const bool foot = joint.find("Foot") != std::string::npos;
        return (foot || joint.find("Toe") != std::string::npos) &&
               (in_world(f + 1, joint) - in_world(f, joint)).norm() < distance;
      });
    }
    return still;
  }
};

// Rigs whose reference pose faces away, as those of VRM 0. If this fails, headings, loops, cameras
// and pictures of what is moved onto them are turned by half.
TEST_F(GameLoop, AReferencePoseThatFacesAwayChangesNoHeading) {
  walk("walk.anim", 1.1);
  Clip clip = read("walk.anim");
  for (Transform& joint : clip.skeleton.reference) {
    joint = Transform{Vec3::Zero(), axis_rotation(Axis::y, kPi)} * joint;
  }
  write("away.anim", clip);
  for (const std::string name : {"walk.anim", "away.anim"}) {
    loop(name);
    const Vec3 velocity = read("out.anim").provenance.removed_root_motion->velocity;
    EXPECT_GT(velocity.z(), 0.5) << name;
    EXPECT_NEAR(velocity.x(), 0, 0.05) << name;
    ASSERT_EQ(run_here("krok-edit", {name, "--heading", "90deg", "-o", "east.anim"}).exit_code, 0);
    const Clip east = read("east.anim");
    const Vec3 way = at(east, east.frame_count() - 1, "Hips") - at(east, 0, "Hips");
    EXPECT_GT(way.x(), 2) << name;
    EXPECT_NEAR(way.z(), 0, 1) << name << ": the pelvis is turned by its stance";
    const ToolRun shot =
        run_here("krok-cam", {name, "--follow", "Hips", "--view", "front", "-o", "front.cam"});
    ASSERT_EQ(shot.exit_code, 0) << shot.err;
    std::filesystem::copy_file(path("front.cam"), path(name + ".cam"));
  }
  const ToolRun same =
      run_here("krok-diff", {"walk.anim.cam", "away.anim.cam", "--tolerance", "0.1mm"});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
}

TEST_F(GameLoop, MovedAtTheStoredVelocityFeetStay) {
  walk("walk.anim", 1.1);
  const json steps = loop("walk.anim");
  const Clip out = read("out.anim");
  ASSERT_TRUE(out.provenance.removed_root_motion);
  const RootMotion& removed = *out.provenance.removed_root_motion;
  // Two steps a second of 0.7 m.
  EXPECT_NEAR(removed.velocity.z(), 1.4, 0.01);
  EXPECT_NEAR(removed.velocity.x(), 0, 1e-6) << "travels towards +Z";
  EXPECT_EQ(removed.velocity.y(), 0);
  EXPECT_EQ(removed.turn_rate, 0);
  EXPECT_EQ(steps.back()["step"], "place");
  EXPECT_NEAR(steps.back()["velocity"][2].get<double>(), removed.velocity.z(), 1e-8);

  const int end = out.frame_count() - 1;
  for (const std::string& joint : out.skeleton.names) {
    EXPECT_LT((at(out, end, joint) - at(out, 0, joint)).norm(), 1e-5) << joint;
  }
  EXPECT_LT(Vec2(at(out, 0, "Hips").x(), at(out, 0, "Hips").z()).norm(), 1e-5);
  EXPECT_GT(still_frames(out, 1.5e-3), 0.9 * end) << "of " << end;
}

// Would fail if feet that are planted slid where the seam is closed between legs that differ.
TEST_F(GameLoop, ClosingTheSeamDoesNotMoveFeet) {
  walk("even.anim", 0);
  Clip clip = read("even.anim");
  std::vector<Transform> pose(clip.skeleton.names.size());
  for (int f = 0; f < clip.frame_count(); ++f) {
    clip.get_pose(f, pose);
    for (const auto& [thigh, phase] : {std::pair("LeftUpLeg", 0.0), {"RightUpLeg", 2.0}}) {
      const int joint = clip.skeleton.find(thigh);
      const Quat turn = axis_rotation(Axis::x, 0.07 * std::sin(1.1 * f / kRate + phase));
      const Vec3 pivot = pose[static_cast<std::size_t>(joint)].position;
      const auto within = subtree(clip.skeleton, joint);
      for (std::size_t j = 0; j < pose.size(); ++j) {
        if (!within[j]) continue;
        pose[j] = {pivot + turn * (pose[j].position - pivot), turn * pose[j].orientation};
      }
    }
    clip.set_pose(f, pose);
  }
  write("uneven.anim", clip);
  const json steps = loop("uneven.anim");
  const Clip out = read("out.anim");
  const int end = out.frame_count() - 1;
  EXPECT_GT(still_frames(out, 1e-4), 0.8 * end) << "of " << end;
  // What is printed is of the loop, not of the take before.
  const auto looped =
      std::ranges::find(steps, "loop", [](const json& step) { return step["step"]; });
  ASSERT_NE(looped, steps.end());
  EXPECT_LT((*looped)["drift"].get<double>(), 1e-2);
  EXPECT_LT(steps.back()["slide_speed"].get<double>(), 0.03);
  for (const std::string& joint : out.skeleton.names) {
    EXPECT_LT((at(out, end, joint) - at(out, 0, joint)).norm(), 1e-5) << joint;
  }
}

// Would fail if the contacts of a motion in place were those of feet that slide, which are none.
TEST_F(GameLoop, ItsContactsAndItsSpeedAreFound) {
  walk("walk.anim", -0.4);
  loop("walk.anim");
  const json keys = report_here("krok-keys", {"out.anim"})["result"];
  const json before = report_here("krok-keys", {"walk.anim"})["result"];
  std::set<std::string> joints, joints_before;
  for (const json& contact : keys["contacts"]) joints.insert(contact["joint"]);
  for (const json& contact : before["contacts"]) joints_before.insert(contact["joint"]);
  EXPECT_EQ(joints, joints_before);
  const Clip out = read("out.anim");
  for (const json& contact : keys["contacts"]) {
    const double middle = 0.5 * (contact["start"].get<double>() + contact["end"].get<double>());
    const Vec3 place(contact["place"][0], contact["place"][1], contact["place"][2]);
    const auto frame = static_cast<int>(std::lround(middle * kRate));
    EXPECT_LT((at(out, frame, contact["joint"]) - place).norm(), 1e-6);
  }
  // Planted in place it is what it is planted on its way.
  const RootMotion removed = *out.provenance.removed_root_motion;
  write("travelling.anim", carried_along(out, 0, removed));
  for (const char* name : {"out", "travelling"}) {
    const std::string motion = name;
    const std::vector<std::string> plant = {motion + ".anim", "--plant", "--contacts",
                                            "find",           "-o",      motion + "_planted.anim"};
    ASSERT_EQ(run_here("krok-edit", plant).exit_code, 0);
  }
  write("back.anim", carried_along(read("travelling_planted.anim"), 0, {-removed.velocity, 0}));
  const ToolRun same = run_here("krok-diff", {"out_planted.anim", "back.anim"});
  EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
}

TEST_F(GameLoop, ItsVelocityFollowsLaterSteps) {
  walk("walk.anim", 0.3);
  loop("walk.anim");
  const Vec3 before = read("out.anim").provenance.removed_root_motion->velocity;
  const auto after = [&](const std::vector<std::string>& options) {
    std::vector<std::string> all = {"out.anim", "-o", "later.anim"};
    all.insert(all.end(), options.begin(), options.end());
    EXPECT_EQ(run_here("krok-edit", all).exit_code, 0);
    return read("later.anim").provenance.removed_root_motion->velocity;
  };
  const double speed = before.norm();
  EXPECT_LT((after({"--scale", "2"}) - 2 * before).norm(), 1e-9);
  EXPECT_LT((after({"--playback-speed", "1.5"}) - 1.5 * before).norm(), 1e-9);
  EXPECT_LT((after({"--turn", "90deg"}) - Vec3(speed, 0, 0)).norm(), 1e-6);
  EXPECT_LT((after({"--turn", "90deg", "--mirror"}) - Vec3(speed, 0, 0)).norm(), 1e-6)
      << "mirrored first";
  EXPECT_LT((after({"--treadmill"}) - before).norm(), 1e-6) << "nothing more to take out";
}

// Would fail if an engine could not read the speed from the file, or a clip's name not be given.
TEST_F(GameLoop, ItsSpeedIsInTheAnimationsExtras) {
  walk("walk.anim", 0);
  loop("walk.anim");
  const double speed = read("out.anim").provenance.removed_root_motion->velocity.norm();
  ASSERT_EQ(run_here("krok-body", {"walk.anim", "-o", "walker.model"}).exit_code, 0);
  const auto animations = [&](const std::string& file) {
    return json::parse(get(path(file)))["animations"];
  };
  ASSERT_EQ(run_here("krok-skin", {"walker.model", "jog=out.anim", "walk.anim", "--reduce", "0.1mm",
                                   "-o", "hero.gltf"})
                .exit_code,
            0);
  const json skinned = animations("hero.gltf");
  EXPECT_EQ(skinned[0]["name"], "jog");
  EXPECT_EQ(skinned[1]["name"], "walk");
  EXPECT_NEAR(skinned[0]["extras"]["speed"].get<double>(), speed, 1e-6);
  EXPECT_NEAR(skinned[0]["extras"]["velocity"][2].get<double>(), speed, 1e-6);
  EXPECT_EQ(skinned[0]["extras"]["turnRate"], 0);
  EXPECT_FALSE(skinned[1]["extras"].contains("speed"));
  ASSERT_EQ(run_here("krok-export", {"out.anim", "-o", "out.gltf"}).exit_code, 0);
  EXPECT_NEAR(animations("out.gltf")[0]["extras"]["speed"].get<double>(), speed, 1e-6);
  // A file whose own name has the sign is a file.
  std::filesystem::copy(path("walk.anim"), path("a=b.anim"));
  ASSERT_EQ(run_here("krok-skin", {"walker.model", "a=b.anim", "-o", "odd.gltf"}).exit_code, 0);
  EXPECT_EQ(animations("odd.gltf")[0]["name"], "a=b");
}

// Would fail if loops lost their speed on the way to a character, or in silence where they are
// combined.
TEST_F(GameLoop, ItsSpeedGoesAlongToOtherSkeletons) {
  walk("walk.anim", 0);
  loop("walk.anim");
  const Vec3 before = read("out.anim").provenance.removed_root_motion->velocity;
  ASSERT_EQ(run_here("krok-edit", {"walk.anim", "--scale", "1.25", "-o", "tall.anim"}).exit_code,
            0);
  const auto kept = [&](const std::string& tool, const std::vector<std::string>& more) {
    std::vector<std::string> all = {"out.anim", "-o", "moved.anim"};
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(run_here(tool, all).exit_code, 0) << tool;
    const auto removed = read("moved.anim").provenance.removed_root_motion;
    return removed ? removed->velocity : Vec3(Vec3::Zero());
  };
  EXPECT_LT((kept("krok-retarget", {"--onto", "tall.anim"}) - 1.25 * before).norm(), 1e-3);
  EXPECT_LT((kept("krok-ik", {"--look-at", "head=0,1.5m,5m@300ms"}) - before).norm(), 1e-9);
  ASSERT_EQ(run_here("krok-body", {"tall.anim", "-o", "tall.model"}).exit_code, 0);
  ASSERT_EQ(
      run_here("krok-skin", {"tall.model", "out.anim", "--retarget", "-o", "tall.gltf"}).exit_code,
      0);
  const json extras = json::parse(get(path("tall.gltf")))["animations"][0]["extras"];
  EXPECT_NEAR(extras["speed"].get<double>(), 1.25 * before.norm(), 1e-3);
  const ToolRun blended = run_here("krok-blend", {"out.anim", "walk.anim", "-o", "blended.anim"});
  EXPECT_THAT(blended.err, HasSubstr("[motion-in-place]"));
}

// A walk in a circle is straightened; its turning is what an engine does.
TEST_F(GameLoop, TurningIsTakenOutWithItsRate) {
  walk("circle.anim", 0, 25 * kRadiansPerDegree);
  loop("circle.anim");
  const Clip out = read("out.anim");
  // 25 degrees a step, two steps a second.
  EXPECT_NEAR(out.provenance.removed_root_motion->turn_rate / kRadiansPerDegree, 50, 4);
  const int end = out.frame_count() - 1;
  EXPECT_LT((at(out, end, "RightFoot") - at(out, 0, "RightFoot")).norm(), 1e-4);
  EXPECT_GT(still_frames(out, 1.5e-4), 0.9 * end) << "of " << end;
  // In place it cannot turn and be the same again.
  const ToolRun kept =
      run_here("krok-edit", {"circle.anim", "--game-loop", "--loop-turn", "keep", "-o", "k.anim"});
  EXPECT_THAT(kept.err, HasSubstr("[edit-turn]"));
}

// Would fail if a loop of a pack of game animations, which is in place already, were cut, faded,
// turned or refused, or stored as one that does not travel.
TEST_F(GameLoop, ALoopInPlaceIsKept) {
  walk("walk.anim", 0);
  const json cut = loop("walk.anim");
  Clip pack = read("out.anim");
  const double speed = pack.provenance.removed_root_motion->velocity.norm();
  pack.provenance = {};
  write("pack.anim", pack);
  const json steps = loop("pack.anim");
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_EQ(steps[0]["step"], "feet");
  EXPECT_NEAR(steps[0]["speed"].get<double>(), speed, 0.03 * speed);
  const Clip out = read("out.anim");
  EXPECT_TRUE(std::ranges::equal(out.positions, pack.positions));
  ASSERT_TRUE(out.provenance.removed_root_motion);
  EXPECT_NEAR(out.provenance.removed_root_motion->velocity.z(), speed, 0.03 * speed);
  // Its steps are known, too.
  const json gait = report_here("krok-keys", {"pack.anim"})["result"]["gait"];
  EXPECT_EQ(gait["steps"], 2);
  EXPECT_NEAR(gait["speed"].get<double>(), speed, 0.03 * speed);
  EXPECT_NEAR(gait["cadence"].get<double>(), 120, 1);
  // One that stands has no speed.
  for (int f = 1; f < pack.frame_count(); ++f) {
    std::ranges::copy(pack.frame_positions(0), pack.frame_positions(f).begin());
    std::ranges::copy(pack.frame_orientations(0), pack.frame_orientations(f).begin());
  }
  write("idle.anim", pack);
  EXPECT_EQ(loop("idle.anim")[0]["speed"], 0);
  EXPECT_EQ(read("out.anim").provenance.removed_root_motion->velocity, Vec3(0, 0, 0));
}

// Would fail if a loop that ends between two new frames lost its last pose: it would jump at the
// seam, and its steps would not be found.
TEST_F(GameLoop, ALoopStaysClosedAtAnotherRate) {
  walk("walk.anim", 0);
  loop("walk.anim");
  Clip pack = read("out.anim");
  pack.provenance = {};
  write("pack.anim", pack);
  const std::string rate = std::to_string(24.5 / pack.duration());
  for (const char* how : {"linear", "hermite"}) {
    const ToolRun run = run_here(
        "krok-edit", {"pack.anim", "--rate", rate, "--interpolation", how, "-o", "out.anim"});
    EXPECT_THAT(run.err, HasSubstr("so that the loop stays closed"));
    const Clip out = read("out.anim");
    const auto first = out.frame_positions(0), last = out.frame_positions(out.frame_count() - 1);
    for (std::size_t j = 0; j < first.size(); ++j) {
      EXPECT_LT((first[j] - last[j]).norm(), 1e-5f) << j;
    }
  }
  EXPECT_EQ(report_here("krok-keys", {"out.anim"})["result"]["gait"]["steps"], 2);
}

// A fencer's pelvis faces sideways while head and chest look where the walk goes. Would fail if the
// pelvis alone decided which way is forward.
TEST_F(GameLoop, APelvisThatIsTurnedDoesNotTurnTheWalk) {
  walk("walk.anim", 0);
  Clip clip = read("walk.anim");
  const auto hips = static_cast<std::size_t>(clip.skeleton.find("Hips"));
  const Quatf turn = axis_rotation(Axis::y, 1.4).cast<float>();
  for (int f = 0; f < clip.frame_count(); ++f) {
    Quatf& pelvis = clip.frame_orientations(f)[hips];
    pelvis = turn * pelvis;
  }
  write("fencer.anim", clip);
  loop("fencer.anim");
  const Vec3 velocity = read("out.anim").provenance.removed_root_motion->velocity;
  EXPECT_NEAR(velocity.z(), 1.4, 0.02);
  EXPECT_NEAR(velocity.x(), 0, 0.02);
}

// Would fail if a loop that gains height jumped at its seam, without a word.
TEST_F(GameLoop, AClimbIsPartOfTheVelocity) {
  samples::WalkOptions options;
  options.cadence = 120;
  options.steps = 10;
  options.rate = kRate;
  options.rise = 0.1;
  write("stairs.anim", samples::make_walk(options).value().clip);
  const ToolRun run = run_here("krok-edit", {"stairs.anim", "--game-loop", "-o", "out.anim"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("[edit-climb]"));
  const Clip out = read("out.anim");
  EXPECT_NEAR(out.provenance.removed_root_motion->velocity.y(), 0.2, 0.01);
  const int end = out.frame_count() - 1;
  EXPECT_LT((at(out, end, "Hips") - at(out, 0, "Hips")).norm(), 1e-4);
  const ToolRun in_place =
      run_here("krok-edit", {"stairs.anim", "--cycle", "auto", "--treadmill", "-o", "in.anim"});
  EXPECT_THAT(in_place.err, HasSubstr("[edit-climb]"));
}

}  // namespace
}  // namespace krok::test
