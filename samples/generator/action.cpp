#include "samples/generator/action.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/index.h"
#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "samples/generator/curves.h"
#include "samples/generator/walk.h"

namespace krok::samples {

namespace {

constexpr double kActionStature = 1.75;  // of all lengths below
constexpr double kRest = 0.1;            // seconds before it begins and after it ends

// Of a reach: seconds to get there, to stay, to come back.
constexpr double kOut = 0.8, kStay = 0.2, kHome = 0.9;

// 0 far below, x far above, smooth between.
double ramp(double x, double width) {
  return 0.5 * (x + std::sqrt(x * x + width * width));
}

Quat about(Axis axis, double degrees) {
  return axis_rotation(axis, degrees * kRadiansPerDegree);
}

class ActionPoser {
 public:
  using World = std::vector<Transform>;

  ActionPoser(const Actor& actor, const World& stance, Side side)
      : actor_(actor), stance_(stance), side_(side), sign_(side_sign(side)) {
    local_ = stance;
    for (int j = actor.skeleton.joint_count() - 1; j > 0; --j) {
      local_[at(j)] = stance[at(actor.skeleton.parents[at(j)])].inverse() * stance[at(j)];
    }
  }

  double sign() const { return sign_; }
  const ArmJoints& arm(bool other = false) const {
    return actor_.arms[at(static_cast<int>(other ? samples::other(side_) : side_))];
  }
  const LegJoints& leg(bool other = false) const {
    return actor_.legs[at(static_cast<int>(other ? samples::other(side_) : side_))];
  }

  // Joints relative to their parents, from the stance.
  World local() const { return local_; }
  World world(const World& local) const {
    World result = local;
    for (int j = 1; j < actor_.skeleton.joint_count(); ++j) {
      result[at(j)] = result[at(actor_.skeleton.parents[at(j)])] * local[at(j)];
    }
    return result;
  }

  // Bends a limb so that its end is at `target`; by how much it is not. The hinge is the reference
  // pose's: y of the side's arms, x of legs.
  double bring(World& local, int upper, int lower, int end, const Vec3& hinge, const Vec3& target,
               const Vec3& pole) const {
    const World now = world(local);
    TwoBoneChain chain;
    chain.root = now[at(upper)].position;
    chain.middle = now[at(lower)].position;
    chain.end = now[at(end)].position;
    chain.hinge = now[at(upper)].orientation * hinge;
    const TwoBoneSolution solved = solve_two_bone(
        chain,
        {.target = target, .pole = pole, .softness = 0.02 * actor_.stature / kActionStature});
    const Quat a = solved.root_rotation * now[at(upper)].orientation;
    const Quat b = solved.middle_rotation * now[at(lower)].orientation;
    const int parent = actor_.skeleton.parents[at(upper)];
    local[at(upper)].orientation = now[at(parent)].orientation.conjugate() * a;
    local[at(lower)].orientation = a.conjugate() * b;
    return (solved.end - target).norm();
  }

  // The foot where `sole` (joint_to_world of the ankle) has it; the knee bends ahead of the leg.
  void stand(World& local, bool other, const Transform& sole) const {
    const LegJoints& joints = leg(other);
    const Vec3 line = sole.position - world(local)[at(joints.upper)].position;
    const Vec3 knee = line.cross(Vec3(Vec3::UnitX())).normalized();
    bring(local, joints.upper, joints.lower, joints.foot, Vec3::UnitX(), sole.position,
          knee + Vec3(0.1 * (other ? -sign_ : sign_), 0, 0));
    const World now = world(local);
    local[at(joints.foot)].orientation =
        now[at(joints.lower)].orientation.conjugate() * sole.orientation;
  }
  const Transform& ankle(bool other) const { return stance_[at(leg(other).foot)]; }

  // Turns of trunk and head, shared by their joints.
  void bend(World& local, const Quat& trunk, const Quat& head) const {
    const Quat third = slerp(Quat::Identity(), trunk, 1.0 / 3);
    for (const int j : {actor_.spine, actor_.spine1, actor_.spine2}) {
      local[at(j)].orientation = third * local[at(j)].orientation;
    }
    const Quat half = slerp(Quat::Identity(), head, 0.5);
    for (const int j : {actor_.neck, actor_.head}) {
      local[at(j)].orientation = half * local[at(j)].orientation;
    }
  }
  void turn(World& local, int joint, const Quat& rotation) const {
    local[at(joint)].orientation = rotation * local[at(joint)].orientation;
  }

  // Part of the way from the stance.
  World between(const World& there, double part) const {
    World mixed = local_;
    for (std::size_t j = 0; j < mixed.size(); ++j) {
      mixed[j].position += part * (there[j].position - mixed[j].position);
      mixed[j].orientation = slerp(mixed[j].orientation, there[j].orientation, part);
    }
    return mixed;
  }

  // To the side, up and ahead of the other foot's heel.
  Vec3 in_world(const Vec3& target) const {
    const double scale = actor_.stature / kActionStature;
    const Transform& foot = ankle(true);
    const Vec3 heel = foot * actor_.heel;
    const Vec3 toes = foot.orientation * Vec3::UnitZ();
    const Vec3 ahead = Vec3(toes.x(), 0, toes.z()).normalized();
    const Vec3 left = Vec3::UnitY().cross(ahead);
    return heel +
           scale * (target.x() * sign_ * left + target.y() * Vec3::UnitY() + target.z() * ahead);
  }

 private:
  const Actor& actor_;
  const World& stance_;
  Side side_;
  double sign_;
  World local_;
};

// The pose with the hand at the target; legs are bent afterwards.
ActionPoser::World reaching(const ActionPoser& poser, const Actor& actor, const Vec3& target,
                            double& missed) {
  const double scale = actor.stature / kActionStature;
  const double low = ramp(1.15 - target.y(), 0.3), far = ramp(target.z() - 0.4, 0.2);
  const double aside = target.x() - 0.2;
  ActionPoser::World local = poser.local();
  local[at(actor.hips)].position +=
      scale * Vec3(0.06 * poser.sign() * aside, -0.12 * low, 0.1 * far - 0.06 * low);
  const Quat hips = about(Axis::x, 14 * low);
  poser.turn(local, actor.hips, hips);
  const double pitch = 22 * low + 60 * far, yaw = -poser.sign() * (14 * far - 22 * aside);
  poser.bend(local, about(Axis::y, yaw - 6 * poser.sign()) * about(Axis::x, pitch),
             about(Axis::y, poser.sign() * (6 + 30 * aside)) *
                 about(Axis::x, 12 + 20 * low - 0.6 * pitch));
  const ArmJoints& arm = poser.arm();
  poser.turn(local, arm.collar, about(Axis::z, poser.sign() * 16 * (target.y() - 1.1)));
  missed = poser.bring(local, arm.upper, arm.lower, arm.hand, Vec3(0, -poser.sign(), 0),
                       poser.in_world(target), Vec3(0.55 * poser.sign(), -1, -0.35));
  poser.turn(local, arm.hand, about(Axis::z, poser.sign() * 12));
  // The other arm goes along a little.
  const ArmJoints& still = poser.arm(true);
  poser.turn(local, still.upper, about(Axis::x, 6 + 10 * low));
  return local;
}

void add_stand(const LegJoints& leg, double from, double to, const ActionPoser::World& stance,
               MotionKeys& keys) {
  for (const int joint : {leg.foot, leg.toes}) {
    keys.contacts.push_back({joint, from, to, stance[at(joint)].position});
  }
}

struct Plan {
  const ActionOptions& options;
  const Actor& actor;
  const std::vector<Transform>& stance;
  ActionPoser poser;
  Vec3 target;

  void sample(Action& action, double duration, const auto& pose_at) const {
    Clip& clip = action.clip;
    clip.skeleton = actor.skeleton;
    clip.rate = options.rate;
    const double seconds = duration / options.pace;
    clip.resize(static_cast<int>(std::floor(seconds * options.rate + 1e-6)) + 1);
    for (int f = 0; f < clip.frame_count(); ++f) {
      clip.set_pose(f, poser.world(pose_at(duration * f / std::max(1, clip.frame_count() - 1))));
    }
    const double whole = clip.duration() / duration;
    for (Keytime& key : action.keys.keytimes) key.time *= whole;
    for (krok::Contact& stand : action.keys.contacts) {
      stand.start *= whole;
      stand.end *= whole;
    }
    std::ranges::sort(action.keys.contacts, {},
                      [](const krok::Contact& c) { return std::pair(c.start, c.joint); });
  }

  Action reach() const {
    Action action;
    const double touch = kRest + kOut + 0.5 * kStay, end = 2 * kRest + kOut + kStay + kHome;
    action.keys.keytimes = {{kRest, "begin"}, {touch, "touch"}, {end - kRest, "end"}};
    for (const bool other : {true, false}) {
      add_stand(poser.leg(other), 0, end, stance, action.keys);
    }
    const ActionPoser::World there = reaching(poser, actor, target, action.missed);
    sample(action, end, [&](double time) {
      const double out = ease((time - kRest) / kOut);
      const double home = ease((time - kRest - kOut - kStay) / kHome);
      ActionPoser::World local = poser.between(there, out - home);
      for (const bool other : {true, false}) poser.stand(local, other, poser.ankle(other));
      return local;
    });
    return action;
  }

  Action kick() const;
};

// The foot's way through the kick, and what the body does with it.
Action Plan::kick() const {
  Action action;
  const double scale = actor.stature / kActionStature, sign = poser.sign();
  const double lift = kRest + 0.12, back = kRest + 0.42, strike = kRest + 0.66, high = kRest + 0.86,
               down = kRest + 1.5, end = down + kRest;
  action.keys.keytimes = {{kRest, "begin"}, {back, "back"}, {strike, "strike"}, {down, "end"}};
  add_stand(poser.leg(true), 0, end, stance, action.keys);
  add_stand(poser.leg(false), 0, lift, stance, action.keys);
  add_stand(poser.leg(false), down, end, stance, action.keys);
  const Transform& rest = poser.ankle(false);
  const Vec3 home = rest.position, hit = poser.in_world(target);
  const Vec3 behind = home + scale * Vec3(0.03 * sign, 0.34, -0.42);
  const Vec3 after = hit + scale * Vec3(-0.06 * sign, 0.22, 0.16);
  using Knot = KnotCurve::Knot;
  std::vector<KnotCurve> way;
  for (int axis = 0; axis < 3; ++axis) {
    const double speed = scale * (axis == 2 ? 4.0 : axis == 1 ? 0.6 : 0.0);
    way.emplace_back(std::vector<Knot>{{lift, home[axis], 0, 0},
                                       {back, behind[axis], 0, 0},
                                       {strike, hit[axis], speed, 0},
                                       {high, after[axis], 0, 0},
                                       {down, home[axis], 0, 0}});
  }
  const auto bump = [](double time, double from, double top, double to) {
    return time < top ? ease((time - from) / (top - from)) : 1 - ease((time - top) / (to - top));
  };
  double missed = 0;
  sample(action, end, [&](double time) {
    const double weight = ease((time - kRest) / 0.3) - ease((time - down + 0.45) / 0.45);
    const double wound = bump(time, kRest, back, strike + 0.05);
    const double swung = bump(time, back, strike + 0.05, down - 0.1);
    ActionPoser::World local = poser.local();
    local[at(actor.hips)].position +=
        scale * weight * Vec3(-0.065 * sign, -0.02, 0) + scale * Vec3(0, 0, 0.04 * (swung - wound));
    poser.turn(
        local, actor.hips,
        about(Axis::y, sign * (12 * swung - 14 * wound)) * about(Axis::x, 8 * wound - 10 * swung));
    poser.bend(
        local,
        about(Axis::y, -sign * (18 * swung - 20 * wound)) * about(Axis::x, 4 * wound + 16 * swung),
        about(Axis::x, 10 * weight));
    for (const bool other : {true, false}) {
      const double ahead = (other ? 1 : -1) * (swung - wound);
      poser.turn(
          local, poser.arm(other).upper,
          about(Axis::x, -30 * ahead) * about(Axis::z, (other ? -1 : 1) * sign * 18 * weight));
    }
    poser.stand(local, true, poser.ankle(true));
    Transform foot = rest;
    for (int axis = 0; axis < 3; ++axis) foot.position[axis] = way[at(axis)](time);
    foot.orientation = rest.orientation * about(Axis::x, 55 * wound + 20 * swung);
    poser.stand(local, false, foot);
    const ActionPoser::World now = poser.world(local);
    if (std::abs(time - strike) < 0.5 / options.rate) {
      missed = (now[at(poser.leg().foot)].position - hit).norm();
    }
    return local;
  });
  action.missed = missed;
  return action;
}

Status check(const ActionOptions& options) {
  const auto within = [](double value, double least, double most) {
    return value >= least && value <= most;
  };
  if (!within(options.stature, 0.5, 2.5) || !within(options.pace, 0.25, 4) ||
      !within(options.rate, 1, 1000)) {
    return Error("action-option",
                 "the stature is not from 0.5 to 2.5 m, the pace from 0.25 to 4 or the rate from 1 "
                 "to 1000");
  }
  if (options.target && !(options.target->norm() < 10)) {
    return Error("action-option", "the target is farther away than 10 m");
  }
  return {};
}

}  // namespace

Result<Action> make_action(const ActionOptions& options) {
  if (Status status = check(options); !status) return status.error();
  const auto standing = make_standing_actor(options.stature);
  if (!standing) return standing.error();
  const auto& [actor, stance] = *standing;
  const bool reach = options.kind == ActionKind::reach;
  const Plan plan{options, actor, stance, ActionPoser(actor, stance, options.side),
                  options.target.value_or(reach ? Vec3(0.25, 1.15, 0.45) : Vec3(0.1, 0.25, 0.5))};
  return reach ? plan.reach() : plan.kick();
}

}  // namespace krok::samples
