#include "samples/generator/foot_plan.h"

#include <algorithm>
#include <cmath>

#include "samples/generator/gait_curves.h"

namespace krok::samples {

namespace {

constexpr double kToeOut = 6 * kRadiansPerDegree;  // of each foot, outwards (Murray 1964)
constexpr int kPadding = 4;                        // steps planned beyond a steady walk's ends
constexpr double kStandingTime = 0.5;              // seconds
constexpr double kNominalStep = 0.41;              // of the stature: an ordinary step

struct Step {
  double length, turn, rise;
};

// The steps after the first print, in order.
std::vector<Step> steps_of(const WalkOptions& options) {
  const Step step{options.step_length, options.turn, options.rise};
  if (!options.from_standing) {
    return std::vector<Step>(static_cast<std::size_t>(options.steps + 2 * kPadding), step);
  }
  std::vector<Step> steps{{0, 0, 0}};
  steps.insert(steps.end(), static_cast<std::size_t>(options.steps), step);
  steps.push_back({0, 0, 0});
  return steps;
}

// Sets the foot pitch at strike and toe-off from the step lengths and the rise.
void set_pitches(Footprint& print, double length_before, double length_after,
                 const WalkOptions& options) {
  const double nominal = kNominalStep * options.stature;
  const double before = std::clamp(length_before / nominal, 0.0, 1.25);
  const double after = std::clamp(length_after / nominal, 0.0, 1.25);
  const double degree = kRadiansPerDegree;
  print.strike_pitch = 21 * degree * before;
  print.off_pitch = -(22 + 47 * after) * degree;
  print.off_toe_pitch = 0.45 * print.off_pitch;
  if (options.ground == Ground::stairs && options.rise != 0) {
    // Upstairs the foot strikes flat; downstairs the ball strikes first.
    const double climb = std::min(1.0, std::abs(options.rise) / (0.07 * options.stature));
    const double on_stairs = options.rise > 0 ? 0.0 : -16 * degree;
    print.strike_pitch += climb * (on_stairs - print.strike_pitch);
    // The foot is lifted rather than rolled off.
    print.off_pitch += climb * (-24 * degree - print.off_pitch);
    print.off_toe_pitch *= 1 - climb;
  }
}

}  // namespace

Vec3 forward_of(double heading) {
  return {std::sin(heading), 0, std::cos(heading)};
}
Vec3 left_of(double heading) {
  return {std::cos(heading), 0, -std::sin(heading)};
}

double FootPlan::ground_height(const Vec3& place) const {
  if (rise == 0) return prints.front().heel.y();
  double height = prints.front().path_point.y();
  const Footprint* nearest = &prints.front();
  double nearest_distance = 1e30;
  for (const Footprint& print : prints) {
    const Vec3 from_print = place - print.path_point;
    const double along = from_print.dot(forward_of(print.path_heading));
    const double distance = Vec2(from_print.x(), from_print.z()).norm();
    // A turning path may return to the same area: only nearby treads count.
    if (along >= -edge_behind_heel && distance < 1.5) height = print.path_point.y();
    if (distance < nearest_distance) {
      nearest_distance = distance;
      nearest = &print;
    }
  }
  if (ground == Ground::stairs) return height;
  const double along = (place - nearest->path_point).dot(forward_of(nearest->path_heading));
  return nearest->path_point.y() + along * std::tan(nearest->slope);
}

FootPlan plan_feet(const WalkOptions& options, const Actor& actor) {
  const std::vector<Step> steps = steps_of(options);
  const int count = static_cast<int>(steps.size()) + 1;
  // The print before the first requested step.
  const int origin = options.from_standing ? 1 : kPadding;

  FootPlan plan;
  plan.step_time = 60.0 / cadence_of(options);
  plan.rise = options.rise;
  plan.ground = options.ground;
  // A foot is centred on its tread.
  const double foot_length = actor.toe_tip.z() - actor.heel.z();
  plan.edge_behind_heel = std::max(0.0, 0.5 * (options.step_length - foot_length));
  const double stride = 2 * plan.step_time;
  const double slope = options.ground == Ground::slope && options.step_length > 0
                           ? std::atan(options.rise / options.step_length)
                           : 0;

  plan.prints.resize(static_cast<std::size_t>(count));
  Vec3 point = Vec3::Zero();
  double heading = 0;
  for (int i = 0; i < count; ++i) {
    Footprint& print = plan.prints[static_cast<std::size_t>(i)];
    if (i > 0) {
      const Step& step = steps[static_cast<std::size_t>(i - 1)];
      point += forward_of(heading + 0.5 * step.turn) * step.length + Vec3(0, step.rise, 0);
      heading += step.turn;
      print.step_length = step.length;
    }
    print.side = (i - origin) % 2 == 0 ? other(options.first_side) : options.first_side;
    print.path_point = point;
    print.path_heading = heading;
    print.slope = slope;
    print.first_of_foot = i < 2;
    print.last_of_foot = i >= count - 2;
    print.strike = plan.time_of(i);
    print.flat = print.strike + kFootFlat * stride;
    print.off = print.strike + kToeOff * stride;
    print.heel_rise = print.strike + kHeelRise * stride;
    print.ball_rise = print.strike + kBallRise * stride;
  }

  // The requested walk starts at the origin, facing +Z.
  const Footprint start = plan.prints[static_cast<std::size_t>(origin)];
  const Quat back(Eigen::AngleAxisd(-start.path_heading, Vec3::UnitY()));
  for (int i = 0; i < count; ++i) {
    Footprint& print = plan.prints[static_cast<std::size_t>(i)];
    print.path_point = back * Vec3(print.path_point - start.path_point);
    print.path_heading -= start.path_heading;
    print.heading = print.path_heading + side_sign(print.side) * kToeOut;
    print.heel = print.path_point +
                 left_of(print.path_heading) * (side_sign(print.side) * 0.5 * options.step_width);
    const auto length_of = [&](int index) {
      return index < count ? plan.prints[static_cast<std::size_t>(std::max(index, 0))].step_length
                           : 0.0;
    };
    // The swing covers this step and the previous step of the other foot.
    set_pitches(print, 0.5 * (length_of(i) + length_of(i - 1)),
                0.5 * (length_of(i + 1) + length_of(i + 2)), options);
  }

  if (options.from_standing) {
    plan.first_time = plan.time_of(0) - kStandingTime;
    plan.last_time = plan.time_of(count - 1) + plan.step_time + kStandingTime;
  } else {
    plan.first_time = plan.time_of(origin);
    plan.last_time = plan.time_of(origin + options.steps);
  }
  return plan;
}

}  // namespace krok::samples
