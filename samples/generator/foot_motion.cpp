#include "samples/generator/foot_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/euler.h"

#include <cstdlib>
static double E(const char*n,double d){const char*v=getenv(n);return v?atof(v):d;}
namespace krok::samples {

namespace {

constexpr double kClearance = 0.012;  // metres under the sole in mid-swing, at least

// Toes up is a turn about -X.
Quat pitched(double angle) { return axis_rotation(Axis::x, -angle); }

Quat ground_frame(double heading, double slope) {
  return axis_rotation(Axis::y, heading) * pitched(slope);
}

// 0 at both ends with velocity and acceleration, 1 at 3/8: toes need room early in a swing.
double bump(double u) {
  const double v = 1 - u;
  return u * u * u * v * v * v * v * v * (16777216.0 / 84375.0);
}

double strike_rate(const Footprint& print) {
  return -E("S",1.5) * print.strike_pitch / (print.flat - print.strike);
}
double off_rate(const Footprint& print) {
  return E("R",2.1) * print.off_pitch / (print.off - print.heel_rise);
}

}  // namespace

FootMotion::FootMotion(Side side, const FootPlan& plan, const Figure& figure)
    : figure_(figure), stride_(2 * plan.step_time) {
  for (const Footprint& print : plan.prints) {
    if (print.side == side) prints_.push_back(print);
  }
  const double degree = kRadiansPerDegree;
  for (std::size_t i = 0; i < prints_.size(); ++i) {
    const Footprint& print = prints_[i];
    std::vector<KnotCurve::Knot> pitch;
    if (!print.first_of_foot) {
      pitch.push_back({print.strike, print.strike_pitch, strike_rate(print)});
    }
    pitch.push_back({print.flat, 0, 0});
    if (i + 1 == prints_.size()) {
      pitch_.emplace_back(std::move(pitch));
      break;
    }
    const Footprint& next = prints_[i + 1];
    const double swing_time = next.strike - print.off;
    pitch.push_back({print.heel_rise, 0, 0});
    pitch.push_back({print.off, print.off_pitch, off_rate(print)});
    pitch.push_back({print.off + 0.1 * swing_time,
                     print.off_pitch + 0.45 * off_rate(print) * 0.1 * swing_time, 0});
    pitch.push_back({next.strike - 0.1 * swing_time,
                     next.strike_pitch - 0.4 * strike_rate(next) * 0.1 * swing_time, 0});
    pitch.push_back({next.strike, next.strike_pitch, strike_rate(next)});
    pitch_.emplace_back(std::move(pitch));

    const bool ball_first = next.strike_pitch < 0;
    toe_extension_.emplace_back(std::vector<KnotCurve::Knot>{
        {print.off, -print.off_pitch, -off_rate(print)},
        {print.off + 0.1 * swing_time,
         -print.off_pitch - 0.4 * off_rate(print) * 0.1 * swing_time, 0},
        {print.off + 0.4 * swing_time, 22 * degree, 0},
        {next.strike, ball_first ? -next.strike_pitch : 0.0, ball_first ? -strike_rate(next) : 0.0}});

    Swing swing;
    swing.from = ankle_state(i, print.off_pitch, off_rate(print));
    swing.to = ankle_state(i + 1, next.strike_pitch, strike_rate(next));
    swing.direction = next.path_point - print.path_point;
    swing.direction.y() = 0;
    if (swing.direction.norm() > 0) swing.direction.normalize();
    swings_.push_back(swing);
    clear_ground(i, plan);
  }
}

double FootMotion::pitch_at(std::size_t print, double time) const { return pitch_[print](time); }

double FootMotion::toe_extension_at(std::size_t print, double time) const {
  return toe_extension_[print](time);
}

State<Vec3> FootMotion::ankle_state(std::size_t index, double pitch, double rate) const {
  const Footprint& print = prints_[index];
  const Quat ground = ground_frame(print.heading, print.slope);
  const bool on_heel = pitch >= 0;
  const Vec3 pivot = on_heel ? figure_.heel : figure_.toe_joint;
  const Vec3 pivot_place = print.heel + ground * Vec3(pivot - figure_.heel);
  const double c = std::cos(pitch), s = std::sin(pitch);
  // The pivot seen from the ankle, turned by the pitch, and its derivatives by the pitch.
  const Vec3 turned(0, pivot.y() * c + pivot.z() * s, -pivot.y() * s + pivot.z() * c);
  const Vec3 first(0, turned.z(), -turned.y());
  const Vec3 second(0, -turned.y(), -turned.z());
  return {pivot_place - ground * turned, -(ground * Vec3(first * rate)),
          -(ground * Vec3(second * (rate * rate)))};
}

FootPose FootMotion::stance(std::size_t index, double time) const {
  const Footprint& print = prints_[index];
  const double pitch = pitch_at(index, time);
  const Quat ground = ground_frame(print.heading, print.slope);
  FootPose pose;
  pose.ankle = ankle_state(index, pitch, 0).position;
  pose.foot = ground * pitched(pitch);
  pose.toes = pitch < 0 ? ground : pose.foot;
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
  pose.ankle.y() += swing.lift * bump(u);
  // Held back in the first half, where a foot has the next tread's edge before it.
  pose.ankle -= swing.direction * (swing.hold_back * bump(u) * (1 - eased));
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
  const int most_hold_back = plan.rise == 0 ? 0 : 20;
  for (int step = 0; step <= most_hold_back; ++step) {
    swing_of.hold_back = 0.02 * step;
    swing_of.lift = 0;
    double lift = 0;
    for (int k = 1; k < kSamples; ++k) {
      const double u = static_cast<double>(k) / kSamples;
      if (getenv("DBG") && k%6==0 && index==2) { const FootPose pp = swing(index, from.off + u * (to.strike - from.off)); const Vec3 tj = pp.ankle + pp.foot * figure_.toe_joint; printf("u %.2f heel %.1f ball %.1f tip %.1f pitch %.1f\n", u, 1e3*(pp.ankle + pp.foot * figure_.heel).y(), 1e3*(tj+ pp.toes * Vec3(figure_.ball - figure_.toe_joint)).y(), 1e3*(tj+ pp.toes * Vec3(figure_.toe_tip - figure_.toe_joint)).y(), pitch_at(index, from.off + u * (to.strike - from.off))*57.3);}
      const FootPose pose = swing(index, from.off + u * (to.strike - from.off));
      const Vec3 toe_joint = pose.ankle + pose.foot * figure_.toe_joint;
      const std::array<Vec3, 3> sole = {
          pose.ankle + pose.foot * figure_.heel,
          toe_joint + pose.toes * Vec3(figure_.ball - figure_.toe_joint),
          toe_joint + pose.toes * Vec3(figure_.toe_tip - figure_.toe_joint)};
      for (const Vec3& point : sole) {
        const double missing = plan.ground_height(point) - point.y();
        // What is missing at the very ends is rounding, not a place to lift the foot for.
        if (missing > -0.05 && missing + kClearance * bump(u) > 1e-9) {
          lift = std::max(lift, missing / bump(u) + kClearance);
        }
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

const Footprint& FootMotion::print_at(double time) const { return prints_[index_at(time)]; }

FootPose FootMotion::at(double time) const {
  const std::size_t index = index_at(time);
  const bool swings = index + 1 < prints_.size() && time > prints_[index].off;
  return swings ? swing(index, time) : stance(index, time);
}

}  // namespace krok::samples
