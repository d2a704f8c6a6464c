#include "samples/generator/foot_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/quaternion.h"

namespace krok::samples {

namespace {

// The foot is still decelerating at heel strike. In step lengths per squared swing time.
constexpr double kLandingDeceleration = 2.5;
// A flat foot strike, as in stepping in place, has no such forward jolt: the foot is set down with
// a deceleration of four fifths of gravity.
constexpr double kSettingDown = 8;                    // m/s^2, for a stature of 1.75 m
constexpr double kFlatPitch = 9 * kRadiansPerDegree;  // of strikes that are not flat
constexpr double kToesUpInSwing = 20 * kRadiansPerDegree;
constexpr double kClearance = 0.012;  // metres under the sole in mid-swing, at least
// Of the lift: where it is lower, as toes leave and heels land, millimetres under the sole would
// take metres of it.
constexpr double kMinShape = 0.05;

// Toes up is a rotation about -X.
Quat pitched(double angle) {
  return axis_rotation(Axis::x, -angle);
}

Quat ground_frame(double heading, double slope) {
  return axis_rotation(Axis::y, heading) * pitched(slope);
}

// Both are 0 at both ends with velocity and acceleration, and 1 at their peak: in the middle, or at
// 3/8.
double bump(double u) {
  const double v = 4 * u * (1 - u);
  return v * v * v;
}
double early_bump(double u) {
  const double v = 1 - u;
  return u * u * u * v * v * v * v * v * (16777216.0 / 84375.0);
}

// Lift profile of a swing: early on level ground, when the toes need clearance.
double lift_shape(double u, int climb) {
  return climb == 0 ? early_bump(u) : bump(u);
}

// Hold-back profile: upstairs early, while the edge of the next tread is in front of the foot;
// downstairs late and in the opposite direction, until the heel is past the edge.
double hold_shape(double u, int climb) {
  return climb > 0 ? early_bump(u) * (1 - ease(u)) : -early_bump(1 - u) * ease(u);
}

// The heel, and later the ball, rise with the cube of time.
State<double> cubic_rise(double start, double end, double angle) {
  const double duration = end - start;
  return {angle, 3 * angle / duration, 6 * angle / (duration * duration)};
}
State<double> off_pitch(const Footprint& print) {
  return cubic_rise(print.heel_rise, print.off, print.off_pitch);
}
State<double> off_toe_pitch(const Footprint& print) {
  return cubic_rise(print.ball_rise, print.off, print.off_toe_pitch);
}
State<double> strike_pitch(const Footprint& print) {
  return {print.strike_pitch, -1.5 * print.strike_pitch / (print.flat - print.strike), 0};
}

State<double> operator-(const State<double>& a, const State<double>& b) {
  return {a.position - b.position, a.velocity - b.velocity, a.acceleration - b.acceleration};
}

KnotCurve::Knot knot(double time, const State<double>& state) {
  return {time, state.position, state.velocity, state.acceleration};
}

// A turning point shortly after (or before) a moment, extrapolated from the velocity there.
KnotCurve::Knot turning_point(double from, const State<double>& state, double delay) {
  return {from + delay, state.position + 0.45 * state.velocity * delay, 0, 0};
}

// A vector in the sagittal plane of the foot rotated by a pitch over time, with derivatives.
State<Vec3> turned(const Vec3& v, const State<double>& pitch) {
  const double c = std::cos(pitch.position), s = std::sin(pitch.position);
  const Vec3 value(0, v.y() * c + v.z() * s, -v.y() * s + v.z() * c);
  const Vec3 first(0, value.z(), -value.y());
  return {value, first * pitch.velocity,
          first * pitch.acceleration - value * (pitch.velocity * pitch.velocity)};
}

}  // namespace

FootMotion::FootMotion(Side side, const FootPlan& plan, const Actor& actor)
    : actor_(actor), stride_(2 * plan.step_time) {
  for (const Footprint& print : plan.prints) {
    if (print.side == side) prints_.push_back(print);
  }
  for (std::size_t i = 0; i < prints_.size(); ++i) {
    const Footprint& print = prints_[i];
    std::vector<KnotCurve::Knot> pitch;
    if (!print.first_of_foot) pitch.push_back(knot(print.strike, strike_pitch(print)));
    pitch.push_back({print.flat, 0, 0, 0});
    if (i + 1 == prints_.size()) {
      pitch_.emplace_back(std::move(pitch));
      break;
    }
    const Footprint& next = prints_[i + 1];
    const double turning = 0.1 * (next.strike - print.off);
    pitch.push_back({print.heel_rise, 0, 0, 0});
    pitch.push_back(knot(print.off, off_pitch(print)));
    pitch.push_back(turning_point(print.off, off_pitch(print), turning));
    pitch.push_back(turning_point(next.strike, strike_pitch(next), -turning));
    pitch.push_back(knot(next.strike, strike_pitch(next)));
    pitch_.emplace_back(std::move(pitch));

    // Toe extension relative to the foot; on the ground the toes are flat.
    const State<double> flat{0, 0, 0};
    const State<double> bent = off_toe_pitch(print) - off_pitch(print);
    const State<double> down = next.strike_pitch < 0 ? flat - strike_pitch(next) : flat;
    toe_extension_.emplace_back(
        std::vector<KnotCurve::Knot>{knot(print.off, bent),
                                     turning_point(print.off, bent, turning),
                                     {print.off + 4 * turning, kToesUpInSwing, 0, 0},
                                     knot(next.strike, down)});

    Swing swing;
    swing.from = ankle_state(i, off_pitch(print), off_toe_pitch(print));
    swing.to = ankle_state(i + 1, strike_pitch(next), flat);
    if (plan.ground == Ground::stairs) swing.climb = (plan.rise > 0) - (plan.rise < 0);
    swing.direction = next.path_point - print.path_point;
    const double swing_time = next.strike - print.off;
    // Parallel to the ground: a horizontal swing would leave a downhill slope. Treads are level.
    if (plan.ground == Ground::stairs) swing.direction.y() = 0;
    swing.to.acceleration -= swing.direction * (kLandingDeceleration / (swing_time * swing_time));
    swing.direction.y() = 0;
    if (swing.climb == 0) {
      const double flatness = std::max(0.0, 1 - std::abs(next.strike_pitch) / kFlatPitch);
      swing.to.acceleration.y() += flatness * kSettingDown * actor.stature / 1.75;
    }
    if (swing.direction.norm() > 0) swing.direction.normalize();
    swings_.push_back(swing);
    clear_ground(i, plan);
  }
}

double FootMotion::pitch_at(std::size_t print, double time) const {
  return pitch_[print](time);
}

double FootMotion::toe_extension_at(std::size_t print, double time) const {
  return toe_extension_[print](time);
}

double FootMotion::toe_pitch_at(std::size_t index, double time) const {
  const Footprint& print = prints_[index];
  if (print.last_of_foot || time <= print.ball_rise) return 0;
  const double u = (time - print.ball_rise) / (print.off - print.ball_rise);
  return print.off_toe_pitch * u * u * u;
}

State<Vec3> FootMotion::ankle_state(std::size_t index, const State<double>& foot_pitch,
                                    const State<double>& toe_pitch) const {
  const Footprint& print = prints_[index];
  const Quat ground = ground_frame(print.heading, print.slope);
  Vec3 pivot = print.heel;
  State<Vec3> from_ankle;  // the pivot seen from the ankle, in the ground's frame
  if (foot_pitch.position >= 0) {
    from_ankle = turned(actor_.heel, foot_pitch);
  } else {
    pivot += ground * Vec3(actor_.toe_tip - actor_.heel);
    const State<Vec3> foot = turned(actor_.toe_joint, foot_pitch);
    const State<Vec3> toes = turned(actor_.toe_tip - actor_.toe_joint, toe_pitch);
    from_ankle = {foot.position + toes.position, foot.velocity + toes.velocity,
                  foot.acceleration + toes.acceleration};
  }
  return {pivot - ground * from_ankle.position, -(ground * from_ankle.velocity),
          -(ground * from_ankle.acceleration)};
}

FootPose FootMotion::stance(std::size_t index, double time) const {
  const Footprint& print = prints_[index];
  const double pitch = pitch_at(index, time);
  const double toe_pitch = pitch < 0 ? toe_pitch_at(index, time) : pitch;
  const Quat ground = ground_frame(print.heading, print.slope);
  FootPose pose;
  pose.ankle = ankle_state(index, {pitch, 0, 0}, {toe_pitch, 0, 0}).position;
  pose.foot = ground * pitched(pitch);
  pose.toes = ground * pitched(toe_pitch);
  return pose;
}

FootPose FootMotion::swing(std::size_t index, double time) const {
  const Footprint& from = prints_[index];
  const Footprint& to = prints_[index + 1];
  const Swing& swing = swings_[index];
  const double duration = to.strike - from.off;
  const double u = std::clamp((time - from.off) / duration, 0.0, 1.0);
  const double eased = ease(u);
  FootPose pose;
  pose.ankle = quintic(swing.from, swing.to, duration, u * duration);
  pose.ankle.y() += swing.lift * lift_shape(u, swing.climb);
  if (swing.climb != 0) {
    pose.ankle -= swing.direction * (swing.hold_back * hold_shape(u, swing.climb));
  }
  pose.foot = ground_frame(from.heading + (to.heading - from.heading) * eased,
                           from.slope + (to.slope - from.slope) * eased) *
              pitched(pitch_at(index, time));
  pose.toes = pose.foot * pitched(toe_extension_at(index, time));
  return pose;
}

void FootMotion::clear_ground(std::size_t index, const FootPlan& plan) {
  const Footprint& from = prints_[index];
  const Footprint& to = prints_[index + 1];
  Swing& swing_of = swings_[index];
  constexpr int kSamples = 120;
  double best_cost = 1e30;
  Swing best = swing_of;
  const int most_hold_back = swing_of.climb == 0 ? 0 : 20;
  for (int step = 0; step <= most_hold_back; ++step) {
    swing_of.hold_back = 0.02 * step;
    swing_of.lift = 0;
    double lift = 0;
    for (int k = 2; k < kSamples - 1; ++k) {
      const double u = static_cast<double>(k) / kSamples;
      const double shape = lift_shape(u, swing_of.climb);
      if (shape < kMinShape) continue;
      const FootPose pose = swing(index, from.off + u * (to.strike - from.off));
      const Vec3 toe_joint = pose.ankle + pose.foot * actor_.toe_joint;
      const std::array<Vec3, 3> sole = {
          pose.ankle + pose.foot * actor_.heel,
          toe_joint + pose.toes * Vec3(actor_.ball - actor_.toe_joint),
          toe_joint + pose.toes * Vec3(actor_.toe_tip - actor_.toe_joint)};
      for (const Vec3& point : sole) {
        const double missing = plan.ground_height(point) - point.y();
        lift = std::max(lift, missing / shape + kClearance);
      }
    }
    const double cost = lift + 0.3 * swing_of.hold_back;
    if (cost < best_cost) {
      best_cost = cost;
      best = swing_of;
      best.lift = lift;
    }
  }
  swing_of = best;
}

std::size_t FootMotion::index_at(double time) const {
  std::size_t index = 0;
  while (index + 1 < prints_.size() && prints_[index + 1].strike <= time) ++index;
  return index;
}

const Footprint& FootMotion::print_at(double time) const {
  return prints_[index_at(time)];
}

FootPose FootMotion::at(double time) const {
  const std::size_t index = index_at(time);
  const bool swings = index + 1 < prints_.size() && time > prints_[index].off;
  return swings ? swing(index, time) : stance(index, time);
}

}  // namespace krok::samples
