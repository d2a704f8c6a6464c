#include "plant/leg_pose_internal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "plant/smooth_curve_internal.h"

namespace krok::plant {

namespace {

constexpr double kSpread = 0.3;    // seconds
constexpr double kReached = 1e-5;  // metres

// A leg in one frame, as captured but for the pelvis.
struct LegNow {
  Transform upper, lower, foot;
  double thigh = 0, shank = 0, reach = 0;  // metres; reach from hip to ankle
  Vec3 goal = Vec3::Zero();                // of the ankle

  LegNow(const Clip& clip, int frame, const Leg& leg, const FootPath& path, double lowered) {
    const auto f = static_cast<std::size_t>(frame);
    upper = joint_at(clip, frame, leg.upper);
    lower = joint_at(clip, frame, leg.lower);
    foot = joint_at(clip, frame, leg.foot);
    goal = foot.position + path.shift[f];
    for (Transform* joint : {&upper, &lower, &foot}) joint->position.y() -= lowered;
    thigh = (lower.position - upper.position).norm();
    shank = (foot.position - lower.position).norm();
    reach = (foot.position - upper.position).norm();
  }
};

// How far down the hip must come for the ankle to be within `reach` of it, >= 0; where it stands
// too far off to the side, as far as brings it nearest.
double drop_for(const Vec3& from_hip, double reach) {
  if (from_hip.norm() <= reach) return 0;
  const double level = from_hip.x() * from_hip.x() + from_hip.z() * from_hip.z();
  const double below = reach * reach > level ? std::sqrt(reach * reach - level) : 0;
  return std::max(0.0, -from_hip.y() - below);
}

// The pose of a chain, and the rotations that lead there.
TwoBoneSolution solve(const Leg& leg, const LegNow& now) {
  TwoBoneChain chain{now.upper.position, now.lower.position, now.foot.position, Vec3::Zero()};
  const Vec3 usual = now.upper.orientation * leg.knee_axis;
  const Vec3 hinge = Vec3(chain.middle - chain.root).cross(Vec3(chain.end - chain.middle));
  const double sine = hinge.norm() / std::max(1e-12, now.thigh * now.shank);
  chain.hinge = sine > 1e-5 ? Vec3(hinge.normalized()) : usual;
  TwoBoneGoal goal;
  goal.target = now.goal;
  // Bend that is added is about the usual axis: what a leg that is nearly straight shows of its
  // plane is mostly error.
  const double bend = two_bone_bend(now.thigh, now.shank, now.reach);
  const double then = two_bone_bend(now.thigh, now.shank, (goal.target - chain.root).norm());
  const double agree = std::max(0.0, chain.hinge.dot(usual));
  const Vec3 axis = bend * chain.hinge + std::max(0.0, then - bend) * agree * usual;
  const Vec3 line = goal.target - chain.root;
  const Quat swing = shortest_arc(chain.end - chain.root, line);
  goal.pole = line.cross(swing * (axis.norm() > 1e-9 ? axis : usual));
  return solve_two_bone(chain, goal);
}

// x -> then + turn (x - now), for all joints of one body.
struct Move {
  Vec3 now = Vec3::Zero(), then = Vec3::Zero();
  Quat turn = Quat::Identity();

  Vec3 operator()(const Vec3& place) const { return then + turn * Vec3(place - now); }
};

constexpr std::size_t kBodies = 6;
using Moves = std::array<Move, kBodies>;  // [Body]

Moves moves_of(const Clip& clip, int frame, const Leg& leg, const LegNow& now, const Vec3& turn) {
  const TwoBoneSolution solution = solve(leg, now);
  const auto captured = [&](int joint) { return joint_at(clip, frame, joint).position; };
  Moves moves;
  const auto set = [&](Body body, int joint, const Vec3& then, const Quat& rotation) {
    moves[static_cast<std::size_t>(body)] = {captured(joint), then, rotation};
  };
  const Quat of_foot = from_rotation_vector(turn);
  set(Body::upper, leg.upper, now.upper.position, solution.root_rotation);
  set(Body::lower, leg.lower, solution.middle, solution.middle_rotation);
  set(Body::foot, leg.foot, solution.end, of_foot);
  if (leg.toes >= 0) {
    const Vec3 toes = moves[static_cast<std::size_t>(Body::foot)](captured(leg.toes));
    set(Body::toes, leg.toes, toes, from_rotation_vector(turn_of_toes(turn)));
  }
  return moves;
}

}  // namespace

std::vector<double> lowering(const Clip& clip, const PlantedBody& body,
                             const std::vector<FootPath>& paths) {
  const auto frames = static_cast<std::size_t>(clip.frame_count());
  std::vector<double> bounds(frames, 0);
  for (std::size_t i = 0; i < body.legs.size(); ++i) {
    for (std::size_t f = 0; f < frames; ++f) {
      const LegNow now(clip, static_cast<int>(f), body.legs[i], paths[i], 0);
      const double longest =
          std::max(now.reach, two_bone_reach(now.thigh, now.shank, kNearlyStraight));
      bounds[f] = std::min(bounds[f], -drop_for(now.goal - now.upper.position, longest));
    }
  }
  std::vector<double> lowered =
      smooth_below(bounds, static_cast<int>(std::lround(kSpread * clip.rate)));
  for (double& metres : lowered) metres = std::max(0.0, -metres);
  return lowered;
}

int apply(const PlantedBody& body, const std::vector<FootPath>& paths,
          const std::vector<double>& lowered, Clip& clip) {
  int out_of_reach = 0;
  std::array<Moves, 2> moves;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto f = static_cast<std::size_t>(frame);
    const Vec3 shift = -lowered[f] * Vec3::UnitY();
    bool reached = true;
    for (std::size_t i = 0; i < body.legs.size(); ++i) {
      const LegNow now(clip, frame, body.legs[i], paths[i], lowered[f]);
      moves[i] = moves_of(clip, frame, body.legs[i], now, paths[i].turn[f]);
      reached = reached &&
                (moves[i][static_cast<std::size_t>(Body::foot)].then - now.goal).norm() < kReached;
    }
    if (!reached) ++out_of_reach;
    const auto positions = clip.frame_positions(frame);
    const auto orientations = clip.frame_orientations(frame);
    const Vec3f plain = shift.cast<float>();
    for (std::size_t j = 0; j < body.bodies.size(); ++j) {
      if (body.bodies[j] == Body::none) continue;
      if (body.bodies[j] == Body::pelvis) {
        positions[j] += plain;
        continue;
      }
      const Move& move = moves[body.side[j]][static_cast<std::size_t>(body.bodies[j])];
      positions[j] = move(positions[j].cast<double>()).cast<float>();
      orientations[j] = (move.turn * orientations[j].cast<double>()).normalized().cast<float>();
    }
  }
  return out_of_reach;
}

}  // namespace krok::plant
