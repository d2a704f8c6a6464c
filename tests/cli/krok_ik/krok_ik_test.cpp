// If these fail, krok-ik writes another motion than its goals ask for, hides that a goal was missed
// and why, or ends wrongly on wrong input.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "cli/motion_fixture.h"
#include "core/index.h"
#include "math/quaternion.h"
#include "samples/generator/walk.h"

namespace krok::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class KrokIk : public test::MotionTest {
 protected:
  void SetUp() override {
    samples::WalkOptions options;
    options.steps = 3;
    options.rate = 30;
    walk_ = samples::make_walk(options)->clip;
    anim::WriteOptions exact;
    exact.orientation = OrientationEncoding::xyzw;
    write("walk.anim", walk_, exact);
  }

  test::ToolRun ik(std::vector<std::string> arguments) const {
    return run_here("krok-ik", std::move(arguments));
  }

  Vec3 place(const Clip& clip, int frame, const char* joint) const {
    return clip.frame_positions(frame)[at(clip.skeleton.find(joint))].cast<double>();
  }

  // "RightHand=x,y,z@30f": the hand's place in frame 30, moved.
  std::string reach(const Vec3& by, const std::string& time = "30f") const {
    const Vec3 to = place(walk_, 30, "RightHand") + by;
    return "RightHand=" + std::to_string(to.x()) + "m," + std::to_string(to.y()) + "m," +
           std::to_string(to.z()) + "m@" + time;
  }

  Clip walk_;
};

TEST_F(KrokIk, AHandReachesAPlaceAtItsTimeAndTheRestStays) {
  const auto run = ik({"walk.anim", "--reach", reach(Vec3(0, 0.1, 0.05)), "--fade", "200ms", "-o",
                       "out.anim", "-v", "--orientation", "xyzw"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, HasSubstr("RightHand (position): reached in"));
  const Clip out = read("out.anim");
  const Vec3 wanted = place(walk_, 30, "RightHand") + Vec3(0, 0.1, 0.05);
  EXPECT_LT((place(out, 30, "RightHand") - wanted).norm(), 1e-4);
  EXPECT_EQ(place(out, 20, "RightHand"), place(walk_, 20, "RightHand"));
  EXPECT_EQ(place(out, 30, "LeftFoot"), place(walk_, 30, "LeftFoot"));
  EXPECT_EQ(out.provenance.tool, "krok-ik");
  ASSERT_FALSE(out.provenance.conversions.empty());
  EXPECT_THAT(out.provenance.conversions.back(), HasSubstr("inverse kinematics: 1 goal"));
}

// If this fails, what is put on a table or a rail that follows the ground ends beside it.
// A look is reached however far away its place is.
TEST_F(KrokIk, CentimetresWithoutAUnitAreRefused) {
  const auto look = [&](const char* place) {
    return ik({"walk.anim", "--look-at", place, "-o", "out.anim"}).err;
  };
  EXPECT_THAT(look("head=0,160,300@1s"), AllOf(HasSubstr("has no unit"), HasSubstr("160cm")));
  EXPECT_THAT(look("head=0,1.6,3@1s"), Not(HasSubstr("unit")));
  EXPECT_THAT(look("head=0m,160m,300m@1s"), Not(HasSubstr("unit")));
}

// Would fail if a head that looks straight behind itself were written without a word, or if a look
// ahead were blamed.
TEST_F(KrokIk, WhatNobodyCanTurnToIsWarnedOf) {
  const auto look = [&](const char* z, std::vector<std::string> more) {
    more.insert(more.begin(), {"walk.anim", "--look-at", fmt::format("head=0.1m,1.5m,{}@1s", z),
                               "-o", "out.anim"});
    return ik(more).err;
  };
  EXPECT_THAT(look("-9m", {}),
              AllOf(HasSubstr("beyond the range of people"), HasSubstr("[ik-range]")));
  EXPECT_THAT(look("-9m", {"--limits", "auto"}), Not(HasSubstr("[ik-range]")));
  EXPECT_THAT(look("9m", {}), Not(HasSubstr("[ik-range]")));
}

TEST_F(KrokIk, HeightsOfGoalsAreOverTheGround) {
  const auto run = ik({"walk.anim", "--reach", reach(Vec3(0, 0.1 - 0.2, 0.05)), "--fade", "200ms",
                       "--ground", "level:height=20cm", "-o", "out.anim", "--orientation", "xyzw"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Vec3 wanted = place(walk_, 30, "RightHand") + Vec3(0, 0.1, 0.05);
  EXPECT_LT((place(read("out.anim"), 30, "RightHand") - wanted).norm(), 1e-4);
  const auto wrong =
      ik({"walk.anim", "--reach", reach(Vec3::Zero()), "--ground", "levle", "-o", "wrong.anim"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("level"));
}

TEST_F(KrokIk, WhatIsMissedIsToldWithTheJointThatHoldsBack) {
  // As far as the arm and the trunk can never reach, then with an arm that may not bend.
  const auto far = ik({"walk.anim", "--reach", reach(Vec3(5, 0, 0)), "-o", "far.anim", "--json"});
  ASSERT_EQ(far.exit_code, 0) << far.err;
  const json goal = json::parse(far.out)["result"]["goals"][0];
  EXPECT_EQ(goal["joint"], "RightHand");
  EXPECT_GT(goal["largest_distance"].get<double>(), 3);
  EXPECT_TRUE(goal["held_by"].is_null());
  EXPECT_EQ(goal["worst_frame"], 30);
  EXPECT_EQ(goal["frames"].size(), goal["active_frames"]);
  const json issue = json::parse(far.out)["issues"][0];
  EXPECT_EQ(issue["code"], "ik-missed");
  EXPECT_EQ(issue["frame"], 30);
  // In a script that must not go on with it.
  EXPECT_EQ(
      ik({"walk.anim", "--reach", reach(Vec3(5, 0, 0)), "-o", "far.anim", "--strict"}).exit_code,
      1);
  EXPECT_TRUE(std::filesystem::exists(path("far.anim")));
  const auto metres = ik({"walk.anim", "--reach", "RightHand=40,11,30@1s", "-o", "far.anim"});
  EXPECT_THAT(metres.err, HasSubstr("'RightHand' is at "));

  put("stiff.limits.json",
      R"({"schema": "krok.limits/1", "joints": {
  "RightForeArm": {"kind": "hinge", "axis": [0, 1, 0], "range": [-1, 1]},
  "RightShoulder": {"kind": "locked"}, "Spine": {"kind": "locked"},
  "Spine1": {"kind": "locked"}, "Spine2": {"kind": "locked"}}})");
  const Vec3 shoulder = place(walk_, 30, "RightArm");
  const std::string near = "RightHand=" + std::to_string(shoulder.x()) + "," +
                           std::to_string(shoulder.y() - 0.2) + "," +
                           std::to_string(shoulder.z() + 0.1) + "@30f";
  const auto held = ik(
      {"walk.anim", "--reach", near, "--limits", "stiff.limits.json", "-o", "held.anim", "--json"});
  ASSERT_EQ(held.exit_code, 0) << held.err;
  const json result = json::parse(held.out)["result"];
  EXPECT_EQ(result["goals"][0]["held_by"], "RightForeArm");
  EXPECT_LE(result["limits"]["largest_excess"].get<double>(), 1e-6);
}

TEST_F(KrokIk, GoalsComeFromAFileAndFromAnotherMotion) {
  Clip other = walk_;
  for (Vec3f& position : other.positions) position += Vec3f(0, 0.05f, 0.03f);
  write("other.anim", other);
  put("goals.json", R"({"schema": "krok.goals/1", "rate": 30, "goals": [
  {"name": "follow", "joint": "left_hand", "motion": "other.anim", "relative_to": "LeftHand",
   "keys": [{"time": "20f", "target": [0, 0, 0]}], "to": "40f", "fade_in": 0.2}]})");
  const auto run = ik({"walk.anim", "--goals", "goals.json", "-o", "out.anim"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Clip out = read("out.anim");
  for (const int frame : {20, 33, 40}) {
    EXPECT_LT((place(out, frame, "LeftHand") - place(other, frame, "LeftHand")).norm(), 1e-4);
  }
  EXPECT_EQ(out.provenance.sources.size(), 3u);
}

TEST_F(KrokIk, LimitsAreLearntAndWritten) {
  const auto learn =
      ik({"walk.anim", "--learn-limits", "walk.anim", "--save-limits", "actor.limits.json"});
  ASSERT_EQ(learn.exit_code, 0) << learn.err;
  EXPECT_THAT(learn.err, HasSubstr("actor.limits.json: limits of "));
  const auto file = InputFile::open(path("actor.limits.json"));
  ASSERT_TRUE(file.ok());
  const json limits = json::parse(file->text());
  // The generated walker swings its arms about one axis.
  EXPECT_EQ(limits["joints"]["LeftArm"]["kind"], "hinge");
}

TEST_F(KrokIk, AutoLimitsAreWrittenAndReadAgain) {
  const auto make = ik({"walk.anim", "--limits", "auto", "--save-limits", "auto.limits.json"});
  ASSERT_EQ(make.exit_code, 0) << make.err;
  const auto by_file = ik({"walk.anim", "--limits", "auto.limits.json", "--reach",
                           reach(Vec3(0, 0.2, 0.2)), "-o", "a.anim", "--orientation", "xyzw"});
  const auto by_name = ik({"walk.anim", "--limits", "auto", "--reach", reach(Vec3(0, 0.2, 0.2)),
                           "-o", "b.anim", "--orientation", "xyzw"});
  ASSERT_EQ(by_file.exit_code, 0) << by_file.err;
  ASSERT_EQ(by_name.exit_code, 0) << by_name.err;
  const Clip a = read("a.anim"), b = read("b.anim");
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    EXPECT_LT((a.positions[i] - b.positions[i]).norm(), 1e-5f);
  }
}

TEST_F(KrokIk, EveryMethodReachesAnEasyGoal) {
  for (const char* method : {"least-squares", "ccd", "two-bone"}) {
    const auto run = ik({"walk.anim", "--reach", reach(Vec3(0, 0.05, 0.02)), "--solver", method,
                         "--iterations", "300", "-o", std::string(method) + ".anim"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Vec3 wanted = place(walk_, 30, "RightHand") + Vec3(0, 0.05, 0.02);
    EXPECT_LT((place(read(std::string(method) + ".anim"), 30, "RightHand") - wanted).norm(), 1e-4)
        << method;
  }
}

TEST_F(KrokIk, StiffnessAndDepthReachTheSolver) {
  const Vec3 by(0.1, 0.2, 0.3);
  const auto spine_moved = [&](std::vector<std::string> more) {
    std::vector<std::string> all = {"walk.anim", "--reach",       reach(by), "-o",
                                    "out.anim",  "--orientation", "xyzw"};
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(ik(all).exit_code, 0);
    const Clip out = read("out.anim");
    return (place(out, 30, "Neck") - place(walk_, 30, "Neck")).norm();
  };
  const double free = spine_moved({"--whole-body", "1"});
  EXPECT_GT(free, 0.01);
  EXPECT_LT(spine_moved({}), 0.5 * free);
  EXPECT_LT(spine_moved({"--stiffness", "spine=0.9", "--stiffness", "chest=0.9"}), free);
  EXPECT_EQ(spine_moved({"--depth", "4"}), 0);
}

// A person who reaches what an arm reaches leans by a few degrees, and looks where he looked.
TEST_F(KrokIk, ArmsReachBeforeTheTrunkAndTheHeadKeepsItsDirection) {
  const Vec3 shoulder = place(walk_, 30, "RightArm");
  const double arm = (place(walk_, 30, "RightForeArm") - shoulder).norm() +
                     (place(walk_, 30, "RightHand") - place(walk_, 30, "RightForeArm")).norm();
  const auto turned = [&](const Clip& clip, const char* joint) {
    const auto j = at(clip.skeleton.find(joint));
    return angle_between(walk_.frame_orientations(30)[j].cast<double>(),
                         clip.frame_orientations(30)[j].cast<double>()) /
           kRadiansPerDegree;
  };
  const std::pair<double, double> degrees[] = {{0.4, 3}, {0.7, 8}, {0.95, 20}, {1.05, 30}};
  for (const auto& [lengths, most] : degrees) {
    const Vec3 by =
        shoulder + lengths * arm * Vec3(0, -0.3, 1).normalized() - place(walk_, 30, "RightHand");
    const auto run = ik(
        {"walk.anim", "--reach", reach(by), "-o", "out.anim", "--json", "--orientation", "xyzw"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Clip out = read("out.anim");
    EXPECT_LT((place(out, 30, "RightHand") - place(walk_, 30, "RightHand") - by).norm(), 1e-4);
    EXPECT_LT(turned(out, walk_.skeleton
                              .names[at(walk_.skeleton.parents[at(walk_.skeleton.find("Neck"))])]
                              .c_str()),
              most)
        << lengths;
    EXPECT_LT(turned(out, "Head"), 0.01) << lengths;
    EXPECT_GT(json::parse(run.out)["result"]["largest_turn"]["angle"], 0);
  }
}

// Would fail if a hand dragged the feet of rigs whose thighs hang on the spine (Biped), if all of
// the body slid along with it, or if feet left their places without a word.
TEST_F(KrokIk, FeetStayAndAreWarnedOfWhereTheyCannot) {
  Clip biped = walk_;
  std::vector<int>& parents = biped.skeleton.parents;
  const int spine = biped.skeleton.find("Spine");
  Skeleton ordered;
  std::vector<int> order = {0, spine};
  for (int j = 1; j < biped.joint_count(); ++j) {
    if (j != spine) order.push_back(j);
    if (parents[at(j)] == 0 && j != spine) parents[at(j)] = spine;
  }
  for (const int j : order) {
    const int parent = parents[at(j)];
    ordered.add(biped.skeleton.names[at(j)],
                parent < 0 ? -1 : ordered.find(biped.skeleton.names[at(parent)]),
                biped.skeleton.reference[at(j)], biped.skeleton.end_sites[at(j)] != 0);
  }
  for (int f = 0; f < walk_.frame_count(); ++f) {
    for (std::size_t k = 0; k < order.size(); ++k) {
      biped.frame_positions(f)[k] = walk_.frame_positions(f)[at(order[k])];
      biped.frame_orientations(f)[k] = walk_.frame_orientations(f)[at(order[k])];
    }
  }
  biped.skeleton = ordered;
  anim::WriteOptions exact;
  exact.orientation = OrientationEncoding::xyzw;
  write("biped.anim", biped, exact);
  const std::string far = reach(Vec3(0, -0.3, 0.4));
  const auto held = ik({"biped.anim", "--reach", far, "-o", "out.anim"});
  ASSERT_EQ(held.exit_code, 0) << held.err;
  EXPECT_THAT(held.err, Not(HasSubstr("ik-feet")));
  EXPECT_LT((place(read("out.anim"), 30, "LeftFoot") - place(biped, 30, "LeftFoot")).norm(), 1e-6);
  for (const std::vector<std::string>& whole :
       {std::vector<std::string>{"--root-moves"}, {"--depth", "0"}}) {
    std::vector<std::string> arguments = {"biped.anim", "--reach", far, "-o", "out.anim"};
    arguments.insert(arguments.end(), whole.begin(), whole.end());
    const auto bent = ik(arguments);
    ASSERT_EQ(bent.exit_code, 0) << bent.err;
    EXPECT_THAT(bent.err, Not(HasSubstr("[ik-feet]")));
    const Clip out = read("out.anim");
    EXPECT_LT((place(out, 30, "LeftFoot") - place(biped, 30, "LeftFoot")).norm(), 1e-3);
    EXPECT_GT((place(out, 30, "LeftLeg") - place(biped, 30, "LeftLeg")).norm(), 1e-3);
  }
  const auto pulled =
      ik({"biped.anim", "--reach", reach(Vec3(0, 9, 0)), "--root-moves", "-o", "out.anim"});
  ASSERT_EQ(pulled.exit_code, 0) << pulled.err;
  EXPECT_THAT(pulled.err, HasSubstr("[ik-feet]"));
}

// Would fail if the bone on the ground went under it with the pelvis, as in captures of Bandai
// Namco.
TEST_F(KrokIk, ARootOnTheGroundStaysWhereThePelvisMoves) {
  Clip rooted;
  rooted.rate = walk_.rate;
  rooted.skeleton.add("Ground", -1, Transform());
  for (int j = 0; j < walk_.joint_count(); ++j) {
    rooted.skeleton.add(walk_.skeleton.names[at(j)], walk_.skeleton.parents[at(j)] + 1,
                        walk_.skeleton.reference[at(j)], walk_.skeleton.end_sites[at(j)] != 0);
  }
  rooted.resize(walk_.frame_count());
  for (int f = 0; f < walk_.frame_count(); ++f) {
    rooted.frame_positions(f)[0] = walk_.frame_positions(f)[0].cwiseProduct(Vec3f(1, 0, 1));
    rooted.frame_orientations(f)[0] = Quatf::Identity();
    std::ranges::copy(walk_.frame_positions(f), rooted.frame_positions(f).begin() + 1);
    std::ranges::copy(walk_.frame_orientations(f), rooted.frame_orientations(f).begin() + 1);
  }
  write("rooted.anim", rooted);
  for (const double lower : {0.1, 0.25}) {
    const Vec3 hips = place(rooted, 30, "Hips") - Vec3(0, lower, 0);
    const auto run =
        ik({"rooted.anim", "--root-moves", "--reach",
            fmt::format("Hips={}m,{}m,{}m@30f", hips.x(), hips.y(), hips.z()), "-o", "out.anim"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.err, Not(HasSubstr("[ik-feet]")));
    const Clip out = read("out.anim");
    EXPECT_LT((place(out, 30, "Hips") - hips).norm(), 1e-3);
    for (int f = 0; f < out.frame_count(); ++f) {
      EXPECT_LT((place(out, f, "Ground") - place(rooted, f, "Ground")).norm(), 1e-5) << f;
    }
    EXPECT_LT((place(out, 30, "LeftFoot") - place(rooted, 30, "LeftFoot")).norm(), 1e-3);
  }
}

// Would fail if a skeleton without a person's legs slid along with what it reaches for, without a
// word.
TEST_F(KrokIk, WhatIsNoPersonKeepsItsEndsOnTheGroundOrSaysSo) {
  Clip spider;
  spider.rate = 30;
  const auto add = [&](const char* name, int parent, const Vec3& place) {
    spider.skeleton.add(name, parent, Transform{place, Quat::Identity()});
    return spider.skeleton.joint_count() - 1;
  };
  const int body = add("thorax", -1, Vec3(0, 0.4, 0));
  add("feeler", add("feeler_base", body, Vec3(0, 0.45, 0.2)), Vec3(0, 0.6, 0.4));
  for (int leg = 0; leg < 4; ++leg) {
    const Vec3 out(leg < 2 ? 1 : -1, 0, leg % 2 == 0 ? 1 : -1);
    const int coxa = add(fmt::format("coxa{}", leg).c_str(), body, 0.1 * out + Vec3(0, 0.4, 0));
    const int tibia = add(fmt::format("tibia{}", leg).c_str(), coxa, 0.3 * out + Vec3(0, 0.5, 0));
    add(fmt::format("claw{}", leg).c_str(), tibia, 0.45 * out);
  }
  spider.resize(40);
  for (int f = 0; f < 40; ++f) spider.set_pose(f, spider.skeleton.reference);
  write("spider.anim", spider);
  const std::string far = "feeler=0.05m,0.65m,0.6m@20f";
  const auto held = ik({"spider.anim", "--root-moves", "--reach", far, "-o", "out.anim"});
  ASSERT_EQ(held.exit_code, 0) << held.err;
  EXPECT_THAT(held.err, Not(HasSubstr("[ik-")));
  const Clip out = read("out.anim");
  EXPECT_GT((place(out, 20, "thorax") - place(spider, 20, "thorax")).norm(), 0.005);
  for (const char* claw : {"claw0", "claw1", "claw2", "claw3"}) {
    EXPECT_LT((place(out, 20, claw) - place(spider, 20, claw)).norm(), 1e-3) << claw;
  }
  // Nothing ends near the lowest of its joints, which the goal is for.
  for (Vec3f& position : spider.positions) {
    if (position.y() < 0.3f) position.y() = 0.8f;
  }
  write("flies.anim", spider);
  const auto whole =
      ik({"flies.anim", "--root-moves", "--reach", "feeler=1m,0.1m,1m@20f", "-o", "out.anim"});
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_THAT(whole.err, HasSubstr("[ik-no-feet]"));
}

// A crouch. Would fail if a solver that only sees to it that feet stay bent knees backwards, or
// turned a joint from one frame to the next as no one does.
TEST_F(KrokIk, KneesOfHeldFeetBendAsTheyDo) {
  Clip stiff = walk_;  // its first half is the frame in which the left leg is straightest
  const auto bend = [this](const Clip& clip, int f, const std::string& side) {
    const auto at_joint = [&](const char* joint) { return place(clip, f, (side + joint).c_str()); };
    const Vec3 thigh = at_joint("Leg") - at_joint("UpLeg"),
               shank = at_joint("Foot") - at_joint("Leg");
    const Vec3 across = place(clip, f, "LeftUpLeg") - place(clip, f, "RightUpLeg");
    return std::atan2(thigh.cross(shank).dot(across.normalized()), thigh.dot(shank));
  };
  int straight = 0;
  for (int f = 1; f < walk_.frame_count(); ++f) {
    if (bend(walk_, f, "Left") < bend(walk_, straight, "Left")) straight = f;
  }
  std::vector<Transform> pose(stiff.skeleton.names.size());
  walk_.get_pose(straight, pose);
  // Bent as far backwards, as captures are at times.
  const auto joint = [&](const char* name) -> Transform& {
    return pose[at(stiff.skeleton.find(name))];
  };
  const Vec3 hip = joint("LeftUpLeg").position, knee = joint("LeftLeg").position;
  const Vec3 ankle = joint("LeftFoot").position, line = (ankle - hip).normalized();
  const Vec3 behind = knee - 2 * (knee - hip - line * line.dot(knee - hip));
  joint("LeftUpLeg").orientation =
      shortest_arc(knee - hip, behind - hip) * joint("LeftUpLeg").orientation;
  joint("LeftLeg").orientation =
      shortest_arc(ankle - knee, ankle - behind) * joint("LeftLeg").orientation;
  joint("LeftLeg").position = behind;
  const int half = stiff.frame_count() / 2, middle = half / 2;
  for (int f = 0; f < half; ++f) stiff.set_pose(f, pose);
  write("stiff.anim", stiff);
  const Vec3 hips = place(stiff, 0, "Hips") - Vec3(0, 0.25, 0);
  const std::string low = fmt::format("Hips={}m,{}m,{}m@{}f", hips.x(), hips.y(), hips.z(), middle);
  const auto done =
      ik({"stiff.anim", "--root-moves", "--reach", low, "--fade", "150ms", "-o", "out.anim"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const Clip out = read("out.anim");
  EXPECT_LT(bend(out, 0, "Left"), 0);
  for (const char* side : {"Left", "Right"}) EXPECT_GT(bend(out, middle, side), 0.5) << side;
}

TEST_F(KrokIk, WrongInputEndsWithTwoAndLeavesNoFile) {
  put("bad.json", R"({"schema": "krok.goals/1", "goals": [
  {"joint": "RightHnd", "keys": [{"time": 0, "target": [0, 0, 0]}]}]})");
  put("bad.limits.json", R"({"schema": "krok.limits/1", "joints": {
  "Head": {"kind": "cone"}}})");
  const std::string good = reach(Vec3(0, 0.1, 0));
  struct Case {
    std::vector<std::string> arguments;
    const char* says;
  };
  const Case cases[] = {
      {{"walk.anim", "-o", "x.anim"}, "no goals"},
      {{"walk.anim", "--reach", good}, "no output given"},
      {{"walk.anim", "--reach", "RightHand=1,2@3s", "-o", "x.anim"}, "three lengths"},
      {{"walk.anim", "--reach", "RightHand=1,2,3", "-o", "x.anim"}, "no time"},
      {{"walk.anim", "--reach", "=1,2,3@1s", "-o", "x.anim"}, "no joint"},
      {{"walk.anim", "--reach", "RightHand=1,2,nan@1s", "-o", "x.anim"}, "RightHand"},
      {{"walk.anim", "--reach", "RightHand=1,2,3@2s..1s", "-o", "x.anim"}, "before it begins"},
      {{"walk.anim", "--reach", "Nose=1,2,3@1s", "-o", "x.anim"}, "[ik-joint]"},
      {{"walk.anim", "--reach", good, "--stiffness", "Spine=2", "-o", "x.anim"}, "0 to 1"},
      {{"walk.anim", "--reach", good, "--fade", "-1s", "-o", "x.anim"}, "--fade"},
      {{"walk.anim", "--reach", good, "--tolerance", "0mm", "-o", "x.anim"}, "--tolerance"},
      {{"walk.anim", "--save-limits", "y.json"}, "--save-limits is for --limits"},
      {{"walk.anim", "--goals", "bad.json", "-o", "x.anim"}, "bad.json:2:13: error: "},
      {{"walk.anim", "--reach", good, "--limits", "bad.limits.json", "-o", "x.anim"},
       "bad.limits.json:2:11: error: "},
      {{"walk.anim", "--reach", good, "-o", "x.bvh"}, "x.bvh"}};
  for (const Case& one : cases) {
    const auto run = ik(one.arguments);
    EXPECT_EQ(run.exit_code, 2) << one.says;
    EXPECT_THAT(run.err, HasSubstr(one.says));
    EXPECT_FALSE(std::filesystem::exists(path("x.anim"))) << one.says;
  }
}

}  // namespace
}  // namespace krok::test
