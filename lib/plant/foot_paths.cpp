#include "plant/foot_paths_internal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ik/soft_reach.h"
#include "ik/two_bone.h"
#include "math/quaternion.h"
#include "math/window.h"
#include "plant/smooth_curve_internal.h"

namespace krok::plant {

namespace {

constexpr double kJitterSpeed = 0.03;  // metres a second, for a leg of 0.86 m
constexpr double kUsualLeg = 0.86;     // metres
constexpr double kFootLength = 0.22;   // of the leg, heel to ball

constexpr double kMaxLift = 15 * kRadiansPerDegree;
constexpr double kMaxRollingLift = 30 * kRadiansPerDegree;
constexpr double kMinLever = 0.2;  // of the way from ball to ankle
constexpr double kLiftCutoff = 6;  // Hz
constexpr double kSteep = 0.5;     // cosine of a foot's slope

constexpr double kCalmCutoff = 6;      // Hz
constexpr double kCalmJitter = 0.001;  // metres
constexpr double kCalmJoin = 0.05;     // seconds
constexpr double kMaxCalm = 4 * kRadiansPerDegree;

class FootSolver {
 public:
  FootSolver(const Clip& clip, const PlantedBody& body, const Leg& leg, const Footing& footing)
      : clip_(clip),
        leg_(leg),
        footing_(footing),
        speed_(kJitterSpeed * body.leg_length / kUsualLeg),
        lever_(kFootLength * body.leg_length),
        frames_(static_cast<std::size_t>(clip.frame_count())),
        ball_(index_of(FootPart::ball)),
        tip_(index_of(FootPart::tip)),
        usual_sideways_(find_usual_sideways()) {}

  std::vector<Vec3> turns() const {
    KnownCurve turn(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      const FixedStay *heel = stay(0, f), *ball = ball_ < 0 ? nullptr : stay(ball_, f);
      if (!heel || !ball) continue;
      const Vec3 now = track(ball_)[f] - track(0)[f];
      turn.set(f, rotation_vector(shortest_arc(now, ball->place - heel->place)));
    }
    return through(turn, speed_ / lever_);
  }

  // The shift that brings the standing point to its place once the foot is turned.
  KnownCurve shifts(const std::vector<Vec3>& turn) const {
    KnownCurve shift(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      for (const int point : {0, ball_}) {
        const FixedStay* fixed = point < 0 ? nullptr : stay(point, f);
        if (!fixed) continue;
        shift.set(f, fixed->place - turned(point, f, turn[f]));
        break;
      }
    }
    if (tip_ >= 0) hold_tip(turn, shift);
    return shift;
  }

  // The shift that lets the foot, turned so, roll without sliding beside its stays, at the height
  // it has.
  KnownCurve rolling(const std::vector<Vec3>& turn) const {
    KnownCurve shift(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      if (in_stay(f)) shift.set(f, Vec3::Zero());
    }
    for (const Roll& roll : footing_.rolls) {
      auto from = static_cast<std::size_t>(roll.from);
      for (const int point : roll.points) {
        const auto to = from + static_cast<std::size_t>(static_cast<std::ptrdiff_t>(roll.step));
        const Vec3 slid = turned(point, to, turn[to]) - turned(point, from, turn[from]);
        const Vec3 lifted = turned(point, to, turn[to]) - track(point)[to];
        shift.set(to, shift.values[from] - Vec3(slid.x(), 0, slid.z()));
        shift.values[to].y() = -lifted.y();
        from = to;
      }
    }
    return shift;
  }

  // Raises the heel further than captured where the foot rolls on ball or tip and the leg would be
  // stretched: nobody crouches so that a toe may roll.
  void lift_rolling_heel(FootPath& path) const {
    if (ball_ < 0) return;
    KnownCurve lift(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      if (in_stay(f)) lift.set(f, Vec3::Zero());
    }
    for (const Roll& roll : footing_.rolls) {
      int frame = roll.from;
      for (const int point : roll.points) {
        frame += roll.step;
        const auto f = static_cast<std::size_t>(frame);
        if (point != 0) lift.set(f, Vec3(needed_lift(path, f, kMaxRollingLift), 0, 0));
      }
    }
    turn_heel(lift, path);
  }

  std::vector<Vec3> through(const KnownCurve& curve, double speed) const {
    const double cutoff = cutoff_against(jitter_of(curve), speed, clip_.rate);
    return curve_through(curve, {.rate = clip_.rate, .cutoff = cutoff});
  }
  double speed() const { return speed_; }

  // Raises the heel further than captured where ball or tip stand without it and the leg would be
  // stretched.
  void lift_heel(FootPath& path) const {
    if (ball_ < 0) return;
    KnownCurve lift(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      if (stay(0, f)) {
        lift.set(f, Vec3::Zero());
      } else if (stay(ball_, f) || (tip_ >= 0 && stay(tip_, f))) {
        lift.set(f, Vec3(needed_lift(path, f, kMaxLift), 0, 0), Known::roughly);
      }
    }
    turn_heel(lift, path);
  }

  // While heel or ball stands alone, jitter of the foot's orientation would move the ankle and
  // shake the knee. The ankle's shift is smoothed instead, and the foot turned so that its point
  // stays in place; less so where the captured ankle itself jitters, which the shift removes.
  void calm_ankle(FootPath& path) const {
    const std::vector<double> parts = apart_from_flat();
    const double jitter = jitter_of_ankle(parts) / kCalmJitter;
    const double share = 1 / (1 + jitter * jitter);
    const std::vector<Vec3> calm =
        smooth_curve(shifts(path.turn), {.rate = clip_.rate, .cutoff = kCalmCutoff});
    KnownCurve more(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      const FixedStay *heel = stay(0, f), *ball = ball_ < 0 ? nullptr : stay(ball_, f);
      if (!heel && !ball) continue;
      const Vec3 ankle = joint_at(clip_, static_cast<int>(f), leg_.foot).position;
      const Vec3 arm = turned(heel ? 0 : ball_, f, path.turn[f]) - ankle;
      const Vec3 wanted = (heel ? heel : ball)->place - ankle - calm[f];
      const Vec3 turn = rotation_vector(shortest_arc(arm, wanted));
      more.set(f,
               turn * (share * parts[f] * std::min(1.0, kMaxCalm / std::max(turn.norm(), 1e-12))));
    }
    const std::vector<Vec3> turns = curve_through(more, {.rate = clip_.rate});
    for (std::size_t f = 0; f < frames_; ++f) {
      path.turn[f] =
          rotation_vector(from_rotation_vector(turns[f]) * from_rotation_vector(path.turn[f]));
    }
  }

 private:
  bool in_stay(std::size_t f) const {
    return std::ranges::any_of(footing_.stay_at, [f](const auto& at) { return at[f] >= 0; });
  }

  void turn_heel(const KnownCurve& lift, FootPath& path) const {
    const std::vector<Vec3> angles =
        curve_through(lift, {.rate = clip_.rate, .cutoff = kLiftCutoff});
    for (std::size_t f = 0; f < frames_; ++f) {
      const double angle = angles[f].x();
      if (std::abs(angle) < 1e-9) continue;
      path.turn[f] = rotation_vector(from_rotation_vector(angle * sideways(f)) *
                                     from_rotation_vector(path.turn[f]));
    }
  }

  // The deviation of the captured ankle's jitter while heel or ball stands alone, metres.
  double jitter_of_ankle(const std::vector<double>& parts) const {
    KnownCurve captured(frames_);
    for (std::size_t f = 0; f < frames_; ++f) {
      if (parts[f] == 0 || (!stay(0, f) && (ball_ < 0 || !stay(ball_, f)))) continue;
      captured.set(f, joint_at(clip_, static_cast<int>(f), leg_.foot).position);
    }
    return jitter_of(captured);
  }

  // 0 while heel and ball both stand, which fixes the foot's orientation; 1 from kCalmJoin on.
  std::vector<double> apart_from_flat() const {
    std::vector<double> parts(frames_, 1);
    const int reach = std::max(1, static_cast<int>(std::lround(kCalmJoin * clip_.rate)));
    for (std::size_t f = 0; f < frames_; ++f) {
      if (!stay(0, f) || ball_ < 0 || !stay(ball_, f)) continue;
      for (int i = -reach; i <= reach; ++i) {
        const auto g = static_cast<std::ptrdiff_t>(f) + i;
        if (g < 0 || g >= static_cast<std::ptrdiff_t>(frames_)) continue;
        const double u = static_cast<double>(std::abs(i)) / reach;
        double& part = parts[static_cast<std::size_t>(g)];
        part = std::min(part, u * u * (3 - 2 * u));
      }
    }
    return parts;
  }

  // Across the way from ankle to ball, in the world, and as long as that is level.
  Vec3 across(std::size_t f) const {
    const Vec3 ankle = joint_at(clip_, static_cast<int>(f), leg_.foot).position;
    return Vec3::UnitY().cross(Vec3(track(ball_)[f] - ankle).stableNormalized());
  }

  Vec3 find_usual_sideways() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t f = 0; f < frames_ && ball_ >= 0; ++f) {
      sum += joint_at(clip_, static_cast<int>(f), leg_.foot).orientation.conjugate() * across(f);
    }
    return sum.stableNormalized();
  }

  // About this axis the heel comes up. A foot that points down has its usual one: across turns
  // over there.
  Vec3 sideways(std::size_t f) const {
    const Vec3 level = across(f);
    const double u = std::min(1.0, level.norm() / kSteep), share = u * u * (3 - 2 * u);
    const Vec3 usual =
        joint_at(clip_, static_cast<int>(f), leg_.foot).orientation * usual_sideways_;
    return (share * level.stableNormalized() + (1 - share) * usual).stableNormalized();
  }

  // The turn about the ball, radians, that brings the ankle as near to the hip as it was, or within
  // reach of a leg that is nearly straight.
  double needed_lift(const FootPath& path, std::size_t f, double most) const {
    const int frame = static_cast<int>(f);
    const Vec3 hip = joint_at(clip_, frame, leg_.upper).position;
    const Vec3 knee = joint_at(clip_, frame, leg_.lower).position;
    const Vec3 captured = joint_at(clip_, frame, leg_.foot).position;
    const double longest =
        std::max((captured - hip).norm(),
                 two_bone_reach((knee - hip).norm(), (captured - knee).norm(), kNearlyStraight));
    const Vec3 ball = turned(ball_, f, path.turn[f]) + path.shift[f];
    const Vec3 ankle = captured + path.shift[f], axis = sideways(f);
    double angle = 0;
    for (int round = 0; round < 3; ++round) {
      const Vec3 arm = from_rotation_vector(angle * axis) * Vec3(ankle - ball);
      const Vec3 line = ball + arm - hip;
      const double nearer = -axis.cross(arm).dot(line.stableNormalized());
      if (nearer < kMinLever * arm.norm()) break;
      angle = std::clamp(angle + (line.norm() - longest) / nearer, 0.0, most);
    }
    return angle;
  }

  int index_of(FootPart part) const {
    for (std::size_t p = 0; p < leg_.points.size(); ++p) {
      if (leg_.points[p].part == part) return static_cast<int>(p);
    }
    return -1;
  }
  const std::vector<Vec3>& track(int point) const {
    return footing_.tracks[static_cast<std::size_t>(point)];
  }
  const FixedStay* stay(int point, std::size_t f) const {
    const int at = footing_.stay_at[static_cast<std::size_t>(point)][f];
    return at < 0 ? nullptr : &footing_.stays[static_cast<std::size_t>(at)];
  }

  // Where a point is after the turn about the ankle.
  Vec3 turned(int point, std::size_t f, const Vec3& turn) const {
    const int frame = static_cast<int>(f);
    const Vec3 ankle = joint_at(clip_, frame, leg_.foot).position;
    const Vec3 place = track(point)[f];
    const Quat of_foot = from_rotation_vector(turn);
    if (leg_.toes < 0 || point != tip_) return ankle + of_foot * Vec3(place - ankle);
    const Vec3 toes = joint_at(clip_, frame, leg_.toes).position;
    return ankle + of_foot * Vec3(toes - ankle) +
           from_rotation_vector(turn_of_toes(turn)) * Vec3(place - toes);
  }

  // Where the tip alone stands it stays where it is when heel or ball leave, or come down.
  void hold_tip(const std::vector<Vec3>& turn, KnownCurve& shift) const {
    for (std::size_t i = 0; i < footing_.stays.size(); ++i) {
      const FixedStay& fixed = footing_.stays[i];
      if (fixed.point.part != FootPart::tip) continue;
      const auto first = static_cast<std::size_t>(fixed.first);
      const auto last = static_cast<std::size_t>(fixed.last);
      const auto held = [&](std::size_t f) { return shift.is_exact(f); };
      bool alone = true;
      for (std::size_t f = first; f <= last; ++f) alone = alone && !held(f);
      // Roughly, and along the ground: toes bend, and the heights of their ends jitter most of all.
      const auto hold = [&](std::size_t f, const Vec3& place, double lift) {
        if (held(f)) return;
        Vec3 needed = place - turned(tip_, f, turn[f]);
        needed.y() = lift;
        shift.set(f, needed, Known::roughly);
      };
      if (alone) {
        for (std::size_t f = first; f <= last; ++f) hold(f, fixed.place, 0);
        continue;
      }
      std::size_t from = first;
      while (!held(from)) ++from;
      Vec3 place = turned(tip_, from, turn[from]) + shift.values[from];
      double lift = shift.values[from].y();
      for (std::size_t f = first; f < from; ++f) hold(f, place, lift);
      for (std::size_t f = from; f <= last; ++f) {
        if (held(f)) {
          place = turned(tip_, f, turn[f]) + shift.values[f];
          lift = shift.values[f].y();
        }
        hold(f, place, lift);
      }
    }
  }

  const Clip& clip_;
  const Leg& leg_;
  const Footing& footing_;
  double speed_, lever_;
  std::size_t frames_;
  int ball_, tip_;
  Vec3 usual_sideways_;  // in the foot's frame
};

}  // namespace

FootPath foot_path(const Clip& clip, const PlantedBody& body, const Leg& leg,
                   const Footing& footing) {
  const FootSolver solver(clip, body, leg, footing);
  FootPath path;
  path.turn = solver.turns();
  path.shift = solver.through(solver.shifts(path.turn), solver.speed());
  solver.lift_heel(path);
  path.shift = solver.through(solver.shifts(path.turn), solver.speed());
  solver.calm_ankle(path);
  path.shift = solver.through(solver.shifts(path.turn), solver.speed());
  return path;
}

FootPath rolling_path(const Clip& clip, const PlantedBody& body, const Leg& leg,
                      const Footing& footing) {
  const FootSolver solver(clip, body, leg, footing);
  FootPath path;
  path.turn.assign(static_cast<std::size_t>(clip.frame_count()), Vec3::Zero());
  path.shift = curve_through(solver.rolling(path.turn), {.rate = clip.rate});
  solver.lift_rolling_heel(path);
  path.shift = curve_through(solver.rolling(path.turn), {.rate = clip.rate});
  return path;
}

KnownCurve needed_shift(const Clip& clip, const PlantedBody& body, const Leg& leg,
                        const Footing& footing) {
  const FootSolver solver(clip, body, leg, footing);
  return solver.shifts(solver.turns());
}

namespace {

constexpr double kSpread = 0.3;    // seconds
constexpr double kMargin = 0.008;  // of the leg
constexpr double kReached = 1e-5;  // metres

constexpr double kBentBack = kPi / 2;  // about the leg's line, from the usual axis
constexpr double kBehind = kPi / 6;
constexpr double kGivesWay = 0.25;     // of the captured flexion
constexpr double kTurnsWithin = 0.05;  // seconds

// 1 for a foot below its hip, which a lower pelvis brings nearer; 0 for one beside or above it, as
// in a cartwheel.
double below_hip(const Vec3& from_hip) {
  constexpr double kBeside = 0.4, kBelow = 0.7;  // cosines of the angle from the vertical
  const double down = -from_hip.y() / std::max(from_hip.norm(), 1e-9);
  const double u = std::clamp((down - kBeside) / (kBelow - kBeside), 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

// A leg in one frame, as captured but for the pelvis.
struct LegNow {
  Transform upper, lower, foot;
  double thigh = 0, shank = 0, reach = 0;  // metres; reach from hip to ankle
  Vec3 wanted = Vec3::Zero();              // from the hip to where the ankle is to be
  double below = 0;                        // of below_hip()
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
    wanted = goal - upper.position;
    below = below_hip(wanted);
    // A foot in the air is not worth a pelvis that goes down or a leg that is stretched.
    const double too_far = wanted.norm() - longest();
    if (too_far > 0) goal -= (1 - below) * too_far * wanted.normalized();
  }

  // From hip to ankle, metres: as captured, or of a leg that is nearly straight.
  double longest() const { return std::max(reach, two_bone_reach(thigh, shank, kNearlyStraight)); }
  // Likewise; as far as the foot is below its hip, the whole length.
  double limit() const {
    const double too_far = std::max(0.0, wanted.norm() - longest());
    return std::min(thigh + shank, longest() + below * too_far);
  }
  double lack() const { return std::max(0.0, wanted.norm() - limit()); }
  bool reached() const {
    const double distance = (goal - upper.position).norm();
    return distance < thigh + shank + kReached && distance > std::abs(thigh - shank) - kReached;
  }

  // Brings the goal within the limit, with this softness (TwoBoneGoal).
  void extend_softly(double softness) {
    const double distance = wanted.norm();
    if (distance <= limit() - softness) return;
    const double soft = std::min(limit(), soft_distance(distance, limit(), softness));
    goal = upper.position + soft / distance * wanted;
  }
};

// Metres by which the hip must be lowered for the ankle to be within `reach` of it, >= 0; if the
// ankle is too far to the side, those that bring it nearest.
double drop_for(const Vec3& from_hip, double reach) {
  if (from_hip.norm() <= reach) return 0;
  const double level = from_hip.x() * from_hip.x() + from_hip.z() * from_hip.z();
  const double below = reach * reach > level ? std::sqrt(reach * reach - level) : 0;
  return std::max(0.0, -from_hip.y() - below);
}

// A knee as captured: its flexion, in radians, and the direction of its axis, as an angle about
// the leg's line from the usual one. What is added flexes about the usual one.
struct Knee {
  double bend = 0, angle = 0, added = 0;
};

Vec3 line_of(const LegNow& now) {
  return (now.foot.position - now.upper.position).stableNormalized();
}

// The usual axis, square to the line from hip to ankle.
Vec3 usual_axis(const Leg& leg, const LegNow& now) {
  const Vec3 line = line_of(now), usual = now.upper.orientation * leg.knee_axis;
  return (usual - line * line.dot(usual)).stableNormalized();
}

Knee knee_of(const Leg& leg, const LegNow& now) {
  const Vec3 thigh = now.lower.position - now.upper.position;
  const Vec3 hinge = thigh.cross(now.foot.position - now.lower.position);
  const Vec3 usual = usual_axis(leg, now);
  Knee knee;
  knee.bend = two_bone_bend(now.thigh, now.shank, now.reach);
  knee.added =
      two_bone_bend(now.thigh, now.shank, (now.goal - now.upper.position).norm()) - knee.bend;
  if (hinge.norm() > 1e-5 * now.thigh * now.shank) {
    knee.angle = std::atan2(line_of(now).dot(usual.cross(hinge)), usual.dot(hinge));
  }
  return knee;
}

// The plane of a nearly straight leg is mostly noise, or that of a knee bent backwards or to a
// side. It gives way to the usual one as flexion is added: all of it does where the knee is bent
// against that, by a quarter of what is captured.
double part_given_way(const Knee& knee) {
  const double added = std::max(0.0, knee.added), bend = std::max(knee.bend, 1e-9);
  if (std::abs(knee.angle) > kBentBack) {
    const double u = std::min(1.0, added / (kGivesWay * bend));
    return u * u * (3 - 2 * u);
  }
  const double straight = std::max(0.0, 1 - bend / kNearlyStraight);
  const double give_way = straight * std::min(1.0, added / bend);
  const double along = bend * std::cos(knee.angle) + added * std::max(0.0, std::cos(knee.angle));
  // Of a knee that is a hinge as of one that is nearly one: what the angle is divided by is not 0.
  const double angle = std::max(std::abs(knee.angle), 1e-6);
  const double left = std::atan2((1 - give_way) * bend * std::sin(angle),
                                 (1 - give_way) * along + give_way * (bend + added));
  return 1 - left / angle;
}

// The directions of the knee's axis, [frames], as Knee::angle. Not from one frame to the next: a
// knee that swings from one side of the leg to the other takes its time.
std::vector<double> knee_angles(const Clip& clip, const Leg& leg, const FootPath& path,
                                const std::vector<double>& lowered) {
  std::vector<double> parts, angles;
  for (int f = 0; f < clip.frame_count(); ++f) {
    const Knee knee = knee_of(leg, {clip, f, leg, path, lowered[static_cast<std::size_t>(f)]});
    parts.push_back(part_given_way(knee));
    // Round the same side as before, first the outer one where it is straight behind: of knees that
    // are hinges rounding would decide.
    const double before = angles.empty() ? 0 : angles.back();
    const bool stays = std::min(std::abs(before), std::abs(knee.angle)) > kBentBack;
    const double outer = leg.side == FootSide::left ? -kPi : kPi;
    const bool behind = std::abs(std::remainder(knee.angle - outer, 2 * kPi)) < kBehind;
    const double from = stays ? before : outer;
    angles.push_back(stays || behind ? from + std::remainder(knee.angle - from, 2 * kPi)
                                     : knee.angle);
  }
  const int reach = static_cast<int>(std::lround(kTurnsWithin * clip.rate));
  // Never less than a frame needs by itself.
  const std::vector<double> around = mean_within(mean_within(parts, reach), reach);
  for (std::size_t f = 0; f < angles.size(); ++f) angles[f] *= 1 - std::max(parts[f], around[f]);
  return angles;
}

// The pose of a chain whose knee's axis is at this angle, and the rotations that lead there. Thigh
// and shank turn about their lengths no more than captured.
TwoBoneSolution solve(const Leg& leg, const LegNow& now, double angle) {
  TwoBoneChain chain{now.upper.position, now.lower.position, now.foot.position, Vec3::Zero()};
  const Vec3 line = line_of(now);
  chain.hinge = from_rotation_vector(angle * line) * usual_axis(leg, now);
  TwoBoneGoal goal;
  goal.target = now.goal;
  const Vec3 wanted = goal.target - chain.root;
  goal.pole = wanted.cross(shortest_arc(line, wanted) * chain.hinge);
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

Moves moves_of(const Clip& clip, int frame, const Leg& leg, const LegNow& now, const Vec3& turn,
               double knee) {
  const TwoBoneSolution solution = solve(leg, now, knee);
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
  std::vector<double> needs(frames, 0);
  for (std::size_t i = 0; i < body.legs.size(); ++i) {
    for (std::size_t f = 0; f < frames; ++f) {
      const LegNow now(clip, static_cast<int>(f), body.legs[i], paths[i], 0);
      needs[f] = std::max(needs[f], drop_for(now.goal - now.upper.position, now.longest()));
    }
  }
  // A little more than needed: a leg at the limit of its reach for a frame bends there least of
  // all, and far more in the frames beside it.
  const double margin = kMargin * body.leg_length;
  for (double& metres : needs) metres += margin * (1 - std::exp(-metres / margin));
  std::vector<double> lowered =
      smooth_above(needs, static_cast<int>(std::lround(kSpread * clip.rate)));
  for (double& metres : lowered) metres = std::max(0.0, metres);
  return lowered;
}

int apply(const PlantedBody& body, const std::vector<FootPath>& paths,
          const std::vector<double>& lowered, Clip& clip) {
  int out_of_reach = 0;
  std::array<Moves, 2> moves;
  std::array<std::vector<double>, 2> knees, softness;
  for (std::size_t i = 0; i < body.legs.size(); ++i) {
    knees[i] = knee_angles(clip, body.legs[i], paths[i], lowered);
    if (!paths[i].extends_softly) continue;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const double metres = lowered[static_cast<std::size_t>(frame)];
      softness[i].push_back(LegNow(clip, frame, body.legs[i], paths[i], metres).lack());
    }
    softness[i] = softness_of(std::move(softness[i]), body.leg_length, clip.rate);
  }
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto f = static_cast<std::size_t>(frame);
    const Vec3 shift = -lowered[f] * Vec3::UnitY();
    bool reached = true;
    for (std::size_t i = 0; i < body.legs.size(); ++i) {
      LegNow now(clip, frame, body.legs[i], paths[i], lowered[f]);
      reached = reached && now.reached();
      if (!softness[i].empty()) now.extend_softly(softness[i][f]);
      moves[i] = moves_of(clip, frame, body.legs[i], now, paths[i].turn[f], knees[i][f]);
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
