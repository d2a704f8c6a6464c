#include "samples/generator/actor.h"

#include <string>

namespace krok::samples {

namespace {

// Heights above the floor and lengths as fractions of stature. Ankle, knee, hip, upper arm,
// forearm, hand, foot and shoulder breadth are from Drillis and Contini; the positions of the spine
// joints and of the ball of the foot are estimates.
constexpr double kAnkleHeight = 0.039;
constexpr double kKneeHeight = 0.285;
constexpr double kHipHeight = 0.530;
constexpr double kHipHalfWidth = 0.050;  // between the hip joints, not the pelvis's outer breadth
constexpr double kFootLength = 0.152;
constexpr double kHeelBehindAnkle = 0.036;
constexpr double kBallFromHeel = 0.108;  // 71 % of the foot's length
constexpr double kToeJointHeight = 0.011;
constexpr double kToeTipHeight = 0.006;
constexpr double kUpperArm = 0.186;
constexpr double kForearm = 0.146;
constexpr double kHand = 0.108;
constexpr double kKnuckles = 0.055;
constexpr double kShoulderHeight = 0.818;
constexpr double kShoulderHalfWidth = 0.112;  // joint centres, inside the biacromial 0.259 / 2

struct Builder {
  Skeleton& skeleton;
  double stature;

  // Adds a joint; position in fractions of stature.
  int add(const std::string& name, int parent, double x, double y, double z,
          bool end_site = false) {
    return skeleton.add(name, parent, {Vec3(x, y, z) * stature, Quat::Identity()}, end_site);
  }
  int end(int parent, double x, double y, double z) {
    const std::string name = skeleton.names[static_cast<std::size_t>(parent)] + "_end";
    return add(name, parent, x, y, z, true);
  }
};

LegJoints add_leg(Builder& build, const std::string& side, double sign, int hips) {
  const double x = sign * kHipHalfWidth;
  LegJoints leg;
  leg.upper = build.add(side + "UpLeg", hips, x, kHipHeight, 0);
  leg.lower = build.add(side + "Leg", leg.upper, x, kKneeHeight, 0);
  leg.foot = build.add(side + "Foot", leg.lower, x, kAnkleHeight, 0);
  leg.toes =
      build.add(side + "ToeBase", leg.foot, x, kToeJointHeight, kBallFromHeel - kHeelBehindAnkle);
  build.end(leg.toes, x, kToeTipHeight, kFootLength - kHeelBehindAnkle);
  return leg;
}

ArmJoints add_arm(Builder& build, const std::string& side, double sign, int chest) {
  const double z = -0.008;
  double x = kShoulderHalfWidth;
  ArmJoints arm;
  arm.collar = build.add(side + "Shoulder", chest, sign * 0.018, 0.812, 0.004);
  arm.upper = build.add(side + "Arm", arm.collar, sign * x, kShoulderHeight, z);
  x += kUpperArm;
  arm.lower = build.add(side + "ForeArm", arm.upper, sign * x, kShoulderHeight, z);
  x += kForearm;
  arm.hand = build.add(side + "Hand", arm.lower, sign * x, kShoulderHeight, z);
  arm.fingers =
      build.add(side + "HandMiddle1", arm.hand, sign * (x + kKnuckles), kShoulderHeight, z);
  build.end(arm.fingers, sign * (x + kHand), kShoulderHeight, z);
  return arm;
}

}  // namespace

Actor make_actor(double stature) {
  Actor actor;
  actor.stature = stature;
  Builder build{actor.skeleton, stature};
  actor.hips = build.add("Hips", Skeleton::kNoParent, 0, 0.545, 0);
  actor.spine = build.add("Spine", actor.hips, 0, 0.590, -0.004);
  actor.spine1 = build.add("Spine1", actor.spine, 0, 0.655, -0.008);
  actor.spine2 = build.add("Spine2", actor.spine1, 0, 0.725, -0.014);
  actor.neck = build.add("Neck", actor.spine2, 0, 0.838, -0.012);
  actor.head = build.add("Head", actor.neck, 0, 0.885, 0.002);
  build.end(actor.head, 0, 1.0, 0.004);
  actor.arms[0] = add_arm(build, "Left", 1, actor.spine2);
  actor.arms[1] = add_arm(build, "Right", -1, actor.spine2);
  actor.legs[0] = add_leg(build, "Left", 1, actor.hips);
  actor.legs[1] = add_leg(build, "Right", -1, actor.hips);

  actor.thigh = (kHipHeight - kKneeHeight) * stature;
  actor.shank = (kKneeHeight - kAnkleHeight) * stature;
  actor.heel = Vec3(0, -kAnkleHeight, -kHeelBehindAnkle) * stature;
  actor.ball = Vec3(0, -kAnkleHeight, kBallFromHeel - kHeelBehindAnkle) * stature;
  actor.toe_tip = Vec3(0, -kAnkleHeight, kFootLength - kHeelBehindAnkle) * stature;
  actor.toe_joint =
      Vec3(0, kToeJointHeight - kAnkleHeight, kBallFromHeel - kHeelBehindAnkle) * stature;
  return actor;
}

}  // namespace krok::samples
