#include "gait/foot_paths_internal.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "gait/body_motion_internal.h"
#include "ik/two_bone.h"
#include "math/hermite.h"
#include "math/quaternion.h"
#include "math/window.h"

namespace krok::gait {

namespace {

// Of the swing, between which the tip of the toes is off the ground.
constexpr double kTipUp = 0.25, kTipDown = 0.92;
constexpr double kAway = 0.09;  // metres from where the foot was or will be, to be cleared in full
constexpr double kBetweenFrames = 3e-4;  // metres, by which a foot may be lower between frames
constexpr double kLanding = 0.12;        // of the swing, in which less and less is to be cleared
constexpr double kRaisedFrom = 0.25, kRaisedInFull = 0.45;  // of the swing
constexpr double kShortestRamp = 0.06;                      // seconds
// Exponents of bumps over a swing, the least sharp first.
constexpr int kShapes[][2] = {{3, 3},  {3, 5},  {5, 3},  {3, 9}, {9, 3},
                              {3, 15}, {15, 3}, {3, 24}, {24, 3}};
constexpr double kMaxToesUp = 15 * kRadiansPerDegree;
constexpr double kToesEdge = 0.25;     // of the bump: below, it does not raise the toes
constexpr double kToesLeftCost = 300;  // per metre, of a radian times the exponents
constexpr double kRamp = 0.35;         // of the time from strike to flat, and from flat to off
constexpr double kMaxHeld = 0.04;  // metres by which a foot is drawn back for the tip of its toes
// Metres over the ground of a tip that has left it: a foot that were held back in the air would
// have to catch up at once.
constexpr double kTipRises = 0.002;
constexpr double kTipSlips = 0.05;      // metres, in the blend, of a tip that has left the ground
constexpr double kLettingGo = 0.3;      // seconds after that
constexpr double kTurningAside = 0.15;  // seconds, in which a foot turns aside in full

double ramp_of(double lasts) {
  return std::min(lasts, std::max(kRamp * lasts, kShortestRamp));
}

double level_distance(const Vec3& a, const Vec3& b) {
  return std::hypot(a.x() - b.x(), a.z() - b.z());
}

// The bump u^a (1 - u)^b, scaled to a peak of 1.
double bump(double u, int a, int b) {
  const double peak = static_cast<double>(a) / (a + b);
  return std::pow(u / peak, a) * std::pow((1 - u) / (1 - peak), b);
}

}  // namespace

FootPose foot_of(const Leg& leg, std::span<const Transform> joint_to_world) {
  FootPose foot;
  foot.foot = joint_to_world[at(leg.foot)];
  foot.toes = leg.toes >= 0 ? joint_to_world[at(leg.toes)].orientation : foot.foot.orientation;
  return foot;
}

std::array<Vec3, 3> sole_points(const Leg& leg, const FootPose& foot) {
  // Ball and tip are the toes'.
  const Quat front =
      leg.toes >= 0 ? foot.toes * leg.flat_toes : foot.foot.orientation * leg.sole.sole;
  const Vec3 ball = foot.foot * leg.sole.pivot +
                    front * (leg.sole.sole.conjugate() * (leg.sole.ball - leg.sole.pivot));
  return {foot.foot * leg.sole.heel, ball, ball + front * Vec3(0, 0, leg.sole.tip)};
}

FootPose in_signs_of(const Leg& leg, const Quat& reference, FootPose foot) {
  foot.foot.orientation = in_hemisphere_of(reference, foot.foot.orientation);
  const Quat flat = foot.foot.orientation * leg.sole.sole * leg.flat_toes.conjugate();
  foot.toes = in_hemisphere_of(flat, foot.toes);
  return foot;
}

Stance::Stance(const Leg& leg, const GroundedPrint& print, const FootPose& middle)
    : leg_(&leg), flat_(flat_foot(leg, print)), middle_(middle.foot.orientation) {
  axes_ = flat_.orientation * leg.sole.sole;
  heel_ = flat_ * leg.sole.heel;
  pivot_ = flat_ * leg.sole.pivot;
}

Vec3 Stance::deviation(const FootPose& blend) const {
  return axes_.conjugate() * rotation_vector(blend.foot.orientation * middle_.conjugate());
}

FootPose Stance::at(double time, const FootPose& blend) const {
  double since = 0, lasts = 0;
  if (time < flat_from) {
    since = flat_from - time, lasts = flat_from - strike;
  } else if (time > flat_to && off > flat_to) {
    since = time - flat_to, lasts = off - flat_to;
  }
  FootPose foot{flat_, axes_ * leg_->flat_toes.conjugate()};
  if (lasts == 0) return foot;
  // Where walks turn, the blend's foot turns on its ball while it is still flat: it takes as long
  // as there is, and what it has no time for is left to the swing.
  const double aside = std::min(1.0, lasts / kTurningAside) * smoother_step(since / lasts);
  Vec3 turn =
      deviation(blend).cwiseProduct(Vec3(smoother_step(since / ramp_of(lasts)), aside, aside));
  if (time < flat_from) {
    const double down = smoother_step((flat_from - time) / (flat_from - strike));
    turn.x() = std::lerp(gait_.landing * turn.x(), down * gait_.toes_down, gait_.forefoot);
  }
  // Once the heel is up the ball stays.
  const bool is_leaving = time > flat_to;
  if (is_leaving) turn.x() = std::max(turn.x(), 0.0);
  if (roll_ > 0) turn.x() += roll_ * smoother_step((time - roll_from_) / (off - roll_from_));
  const bool on_ball = is_leaving || turn.x() > 0;
  const Quat rotation = axes_ * from_rotation_vector(turn) * axes_.conjugate();
  foot.foot.orientation = rotation * flat_.orientation;
  if (on_ball) {
    foot.foot.position = pivot_ - foot.foot.orientation * leg_->sole.pivot;
  } else {
    // The heel rolls without sliding.
    const double radius = leg_->sole.heel_radius;
    const Vec3 middle = heel_ + axes_ * Vec3(0, radius, radius * (1 + turn.x()));
    foot.foot.position = middle - foot.foot.orientation * leg_->sole.heel_middle();
  }
  if (!on_ball) foot.toes = rotation * foot.toes;
  return foot;
}

FootPose Stance::rolled(FootPose foot, double angle) const {
  const Quat turn = from_rotation_vector(axes_ * Vec3(angle, 0, 0));
  foot.foot.orientation = turn * foot.foot.orientation;
  foot.foot.position = pivot_ - foot.foot.orientation * leg_->sole.pivot;
  return foot;
}

void Stance::be_flat(double time, double latest) {
  flat_from = std::max(
      time, std::min(std::max(time + 0.5 * kShortestRamp, strike + kShortestRamp), latest));
}

void Stance::leave(double time, double earliest) {
  flat_to = std::max({std::min(time, off - kShortestRamp), earliest, flat_from});
}

void Stance::land(const SlopeGait& gait, double flat) {
  gait_ = gait;
  flat_from = std::max(flat_from, strike + gait.forefoot * (flat - strike));
}

void Stance::roll_further(double angle, double from) {
  roll_ = angle;
  roll_from_ = from;
  flat_to = std::min(flat_to, from);
}

Swing::Offset Swing::offset_of(const FootPose& blend, const FootPose& wanted) {
  Offset offset;
  offset.head<3>() = wanted.foot.position - blend.foot.position;
  offset.segment<4>(3) =
      in_hemisphere_of(blend.foot.orientation, wanted.foot.orientation).coeffs() -
      blend.foot.orientation.coeffs();
  const Quat in_blend = blend.foot.orientation.conjugate() * blend.toes;
  const Quat in_wanted = wanted.foot.orientation.conjugate() * wanted.toes;
  offset.tail<4>() = in_hemisphere_of(in_blend, in_wanted).coeffs() - in_blend.coeffs();
  return offset;
}

void Swing::set_ends(const Ends& off, const Ends& strike) {
  const auto derive = [&](const Ends& ends, double inwards, std::array<Offset, 3>& to) {
    std::array<Offset, 3> values;
    for (std::size_t i = 0; i < 3; ++i) values[i] = offset_of(ends.blend[i], ends.wanted[i]);
    const double h = ends.spacing;
    to[0] = values[0];
    to[1] = inwards * (3 * values[0] - 4 * values[1] + values[2]) / (2 * h);
    to[2] = (values[0] - 2 * values[1] + values[2]) / (h * h);
  };
  from_ = off.wanted[0].foot.position;
  to_ = strike.wanted[0].foot.position;
  way_ = to_ - from_;
  way_.y() = 0;
  way_ /= std::max(way_.norm(), 1e-9);
  tip_ = sole_points(*leg_, off.wanted[0])[2];
  blend_tip_ = sole_points(*leg_, off.blend[0])[2];
  up_ = off.wanted[0].toes * (leg_->flat_toes * Vec3::UnitY());
  derive(off, 1, start_);
  derive(strike, -1, end_);
}

Vec3 Swing::detour_at(double time, const Detour& detour) const {
  Vec3 result = Vec3::Zero();
  const double part = part_of(time), lifted = part_lifted(time);
  if (detour.lift != 0 && part > 0 && part < 1) {
    result.y() = detour.lift * bump(part, detour.rise, detour.fall);
  }
  if (detour.hold != 0 && lifted > 0 && lifted < 1) {
    result += detour.hold * (detour.hold < 0 ? bump(lifted, 3, 6) : bump(lifted, 6, 3)) * way_;
  }
  return result;
}

FootPose Swing::free_at(double time, const FootPose& blend) const {
  const double length = strike_ - off_, since = time - off_, left = strike_ - time;
  // Velocities are matched within a short time, because blends reach their prints after the strike
  // and leave them before toe-off.
  const double width = std::min(matching_, 0.5 * length);
  const Fading start = fading(since / width), end = fading(left / width);
  const Offset offset =
      fading(since / length).value * start_[0] + fading(left / length).value * end_[0] +
      width * (start.slope * start_[1] - end.slope * end_[1]) +
      width * width * (start.acceleration * start_[2] + end.acceleration * end_[2]);
  FootPose foot;
  foot.foot.position = blend.foot.position + offset.head<3>();
  foot.foot.orientation.coeffs() =
      (blend.foot.orientation.coeffs() + offset.segment<4>(3)).normalized();
  Quat toes = blend.foot.orientation.conjugate() * blend.toes;
  toes.coeffs() = (toes.coeffs() + offset.tail<4>()).normalized();
  foot.toes = foot.foot.orientation * toes;
  return foot;
}

Vec3 Swing::to_tip(const FootPose& foot) const {
  const Vec3 way = tip_ - sole_points(*leg_, foot)[2];
  return way - way.dot(up_) * up_;
}

double Swing::tip_stays_until(double until, std::span<const double> times,
                              std::span<const FootPose> blend) const {
  double stays = off_;
  for (std::size_t i = 0; i < times.size() && times[i] <= until; ++i) {
    if (times[i] <= off_) continue;
    const FootPose free = free_at(times[i], blend[i]);
    const Vec3 slipped = sole_points(*leg_, blend[i])[2] - blend_tip_;
    const double risen = (sole_points(*leg_, free)[2] - tip_).dot(up_);
    if (risen > kTipRises || slipped.norm() > kTipSlips || to_tip(free).norm() > kMaxHeld) {
      return stays;
    }
    stays = times[i];
  }
  return until;
}

void Swing::keep_tip(double until, const std::array<FootPose, 3>& blend, double spacing) {
  lifted_ = until;
  std::array<Vec3, 3> held;
  for (std::size_t i = 0; i < 3; ++i) {
    held[i] = to_tip(free_at(until - spacing * static_cast<double>(i), blend[i]));
  }
  held_[0] = held[0];
  held_[1] = (3 * held[0] - 4 * held[1] + held[2]) / (2 * spacing);
  held_[2] = (held[0] - 2 * held[1] + held[2]) / (spacing * spacing);
}

FootPose Swing::at(double time, const FootPose& blend) const {
  FootPose foot = free_at(time, blend);
  if (lifted_ > off_ && time > off_) {
    if (time <= lifted_) {
      foot.foot.position += to_tip(foot);
    } else {
      const double width = std::min(kLettingGo, strike_ - lifted_);
      const Fading left = fading((time - lifted_) / width);
      foot.foot.position += left.value * held_[0] + width * left.slope * held_[1] +
                            width * width * left.acceleration * held_[2];
    }
  }
  foot.foot.position += detour_at(time, detour_);
  const double part = part_lifted(time);
  if (detour_.toes_up != 0 && part > 0 && part < 1) {
    const double angle = detour_.toes_up * bump(part, detour_.toes_rise, detour_.toes_fall);
    const Quat up = leg_->sole.sole * from_rotation_vector(Vec3(-angle, 0, 0));
    const Quat toes = foot.foot.orientation.conjugate() * foot.toes;
    foot.foot.orientation = foot.foot.orientation * up * leg_->sole.sole.conjugate();
    foot.toes = foot.foot.orientation * toes;
  }
  return foot;
}

double Swing::away(const FootPose& foot) const {
  return std::min(level_distance(foot.foot.position, from_),
                  level_distance(foot.foot.position, to_));
}

double Swing::between_prints(double part, const FootPose& foot) const {
  // A foot that turns or steps on the spot is lifted, too.
  const double middle = (std::min(part, 1 - part) - kRaisedFrom) / (kRaisedInFull - kRaisedFrom);
  return smoother_step(std::max(away(foot) / kAway, middle));
}

double Swing::share_of_clearance(double part, const FootPose& foot) const {
  return between_prints(part, foot) * smoother_step(std::min(part, 1 - part) / kLanding);
}

bool Swing::is_to_be_clear(double time, const FootPose& foot) const {
  return share_of_clearance(part_of(time), foot) == 1;
}

std::vector<Swing::Lack> Swing::lacks(const Terrain& ground, std::span<const double> times,
                                      std::span<const FootPose> blend, double clearance,
                                      double from) const {
  std::vector<Lack> result;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double u = part_of(times[i]);
    if (!(u > 0 && u < 1)) continue;
    const FootPose foot = at(times[i], blend[i]);
    const double wanted = (clearance + kBetweenFrames) * share_of_clearance(u, foot);
    // The tip of the toes rolls over the ground as the foot leaves, and as it lands on the ball.
    auto points = sole_points(*leg_, foot);
    const std::size_t count = u < kTipUp || u > kTipDown ? 2 : 3;
    // Near its prints, the heel is as round as on them.
    const double round = (foot.foot * leg_->sole.heel_middle()).y() - leg_->sole.heel_radius;
    points[0].y() =
        std::lerp(std::max(points[0].y(), round), points[0].y(), between_prints(u, foot));
    for (const Vec3& point : std::span(points).first(count)) {
      const auto found = ground_near(ground, point.x(), point.z(), from, leg_->length);
      if (!found || point.y() - found->height >= wanted) continue;
      const Vec3 ahead = foot.foot.orientation * (leg_->sole.sole * Vec3::UnitZ());
      result.push_back({u, part_lifted(times[i]), wanted - (point.y() - found->height),
                        ahead.dot(point - foot.foot.position)});
    }
  }
  return result;
}

void Swing::raise_toes(std::span<const Lack> missing, Detour& detour) {
  double heel = 0, part = -1, least = std::numeric_limits<double>::infinity();
  std::vector<Lack> ahead;
  for (const Lack& lack : missing) {
    if (lack.part != part) heel = 0;
    part = lack.part;
    if (lack.lever <= 0) {
      heel = lack.height;
    } else if (lack.height > heel) {
      ahead.push_back({lack.part, lack.lifted, lack.height - heel, lack.lever});
    }
  }
  if (ahead.empty()) return;
  for (const auto& [rise, fall] : kShapes) {
    double angle = 0, left = 0;
    for (const Lack& lack : ahead) {
      const double value = bump(std::max(0.0, lack.lifted), rise, fall);
      if (value > kToesEdge) angle = std::max(angle, lack.height / (lack.lever * value));
    }
    angle = std::min(angle, kMaxToesUp);
    for (const Lack& lack : ahead) {
      left = std::max(
          left, lack.height - angle * lack.lever * bump(std::max(0.0, lack.lifted), rise, fall));
    }
    const double cost = angle * (rise + fall) + kToesLeftCost * left;
    if (cost >= least) continue;
    least = cost;
    detour.toes_up = angle, detour.toes_rise = rise, detour.toes_fall = fall;
  }
}

void Swing::clear(const Terrain& ground, std::span<const double> times,
                  std::span<const FootPose> blend, double clearance, double from) {
  constexpr double kHolds[] = {0,     -0.04, 0.04, -0.08, 0.08,  -0.12, 0.12,
                               -0.16, 0.16,  -0.2, 0.2,   -0.26, 0.26};  // metres
  constexpr double kEdge = 0.2;     // of the bump: below, it does not raise the foot
  constexpr double kEnough = 3e-4;  // metres: what is raised less needs no holding
  constexpr double kHoldCost = 1, kLeftCost = 30;
  // People clear the ground by their ankles first.
  detour_ = {};
  Detour best;
  raise_toes(lacks(ground, times, blend, clearance, from), best);
  double least = std::numeric_limits<double>::infinity();
  for (const double hold : kHolds) {
    detour_ = best;
    detour_.lift = 0, detour_.hold = hold;
    const std::vector<Lack> missing = lacks(ground, times, blend, clearance, from);
    for (const auto& [rise, fall] : kShapes) {
      double height = 0, left = 0;
      for (const Lack& lack : missing) {
        const double value = bump(lack.part, rise, fall);
        if (value > kEdge) {
          height = std::max(height, lack.height / value);
        } else {
          left = std::max(left, lack.height);
        }
      }
      // Sharper bumps shake the knee.
      const double cost =
          height * (rise + fall) / 6 + kHoldCost * std::abs(hold) + kLeftCost * left;
      if (cost >= least) continue;
      least = cost;
      best.lift = std::min(height, 0.6 * leg_->length), best.hold = hold;
      best.rise = rise, best.fall = fall;
    }
    if (hold == 0 && least < kEnough) break;
  }
  detour_ = best;
}

namespace {

constexpr double kNearlyStraight = 0.9875;  // of the leg: beyond this a knee turns far for little
// The most that a leg is stretched where the blend's is: nearer to straight, a footprint that is
// off by two millimetres is a knee that turns by six degrees in a frame.
constexpr double kMaxStraight = 0.996;
constexpr double kStraight = 0.9995;

}  // namespace

double longest_reach(const Leg& leg, double blend) {
  return std::max(kNearlyStraight * leg.length, std::min(blend, kMaxStraight * leg.length));
}

double lowering_for(const Walker& walker, std::span<const Transform> joint_to_world,
                    const std::array<FootPose, 2>& target) {
  double lowest = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    const Leg& leg = walker.legs[side];
    const Vec3& hip = joint_to_world[at(leg.upper)].position;
    const double longest = longest_reach(leg, (hip - joint_to_world[at(leg.foot)].position).norm());
    const Vec3 way = hip - target[side].foot.position;
    const double level = std::hypot(way.x(), way.z());
    if (way.norm() <= longest) continue;
    const double height = std::sqrt(std::max(0.0, longest * longest - level * level));
    lowest = std::max(lowest, way.y() - height);
  }
  return std::min(lowest, 0.6 * walker.legs[0].length);
}

std::vector<double> smooth_above(std::span<const double> needs, int reach) {
  constexpr int kRounds = 12;
  constexpr double kGain = 1.2;  // more than 1 because a bump is lower than the peak it stands for
  constexpr double kEnough = 1e-5;  // metres
  // Mirrored at its ends, so that the curve is level there: the walker stands.
  const auto count = static_cast<int>(needs.size()), beyond = std::min(kRounds * reach, count);
  std::vector<double> mirrored;
  for (int i = -beyond; i < count + beyond; ++i) {
    mirrored.push_back(needs[at(i < 0 ? -i - 1 : i < count ? i : 2 * count - i - 1)]);
  }
  std::vector<double> curve(mirrored.size(), 0), missing(mirrored.size());
  const int half = std::max(1, reach / 2);
  for (int round = 0; round <= kRounds; ++round) {
    for (std::size_t i = 0; i < curve.size(); ++i) {
      missing[i] = std::max(0.0, mirrored[i] - curve[i]);
    }
    if (std::ranges::all_of(missing, [](double more) { return more < kEnough; })) break;
    // What is left after all rounds is met everywhere.
    if (round == kRounds) missing = max_within(missing, 2 * half);
    const std::vector<double> bumps = mean_within(mean_within(missing, half), half);
    const double gain = round == kRounds ? 1 : kGain;
    for (std::size_t i = 0; i < curve.size(); ++i) curve[i] += gain * bumps[i];
  }
  return {curve.begin() + beyond, curve.end() - beyond};
}

SolvedLegs solve_legs(const Walker& walker, const std::array<FootPose, 2>& target, double stretch,
                      PoseVector& pose, std::span<Transform> world) {
  SolvedLegs solved;
  const auto refresh = [&](const Leg& leg, int joint) {
    // The path from thigh to toes, joint by joint: helpers in between move along.
    for (const int j : leg.path) {
      if (j < joint) continue;
      world[at(j)] = world[at(walker.skeleton->parents[at(j)])] * joint_of(pose, j);
    }
  };
  const auto turn_to = [&](const Leg& leg, int joint, const Quat& orientation) {
    const Quat parent = world[at(walker.skeleton->parents[at(joint)])].orientation;
    rotation_of(pose, joint) = (parent.conjugate() * orientation).normalized().coeffs();
    refresh(leg, joint);
  };
  for (std::size_t side = 0; side < 2; ++side) {
    const Leg& leg = walker.legs[side];
    const Transform hip = world[at(leg.upper)];
    const Quat knee = world[at(leg.lower)].orientation;
    const Vec3 axis = hip.orientation * leg.knee_axis;
    const Vec3& goal = target[side].foot.position;
    const double distance = (goal - hip.position).norm();
    const double longer = std::clamp(distance - kStraight * leg.length, 0.0, stretch);
    if (longer > 0) {
      const double factor = (leg.length + longer) / leg.length;
      position_of(pose, leg.lower) *= factor;
      position_of(pose, leg.foot) *= factor;
      refresh(leg, leg.upper);
    }
    TwoBoneChain chain{hip.position, world[at(leg.lower)].position, world[at(leg.foot)].position,
                       axis};
    const auto solution =
        solve_two_bone(chain, {.target = goal, .pole = (goal - hip.position).cross(axis)});
    turn_to(leg, leg.upper, solution.root_rotation * hip.orientation);
    turn_to(leg, leg.lower, solution.middle_rotation * knee);
    turn_to(leg, leg.foot, target[side].foot.orientation);
    if (leg.toes >= 0) turn_to(leg, leg.toes, target[side].toes);
    solved.extension = std::max(solved.extension, distance / leg.length);
    solved.missed = std::max(solved.missed, (world[at(leg.foot)].position - goal).norm());
  }
  return solved;
}

}  // namespace krok::gait
