#include "gait/ground_prints_internal.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/numbers.h"
#include "motion/hips_root.h"

namespace krok::gait {

namespace {

constexpr double kStep = 0.6;  // of the leg: what is higher is overhead, or a wall
constexpr double kSteepest =
    35 * kRadiansPerDegree;  // no shoe holds on more, nor does an ankle bend
constexpr double kMaxRoll = 32 * kRadiansPerDegree;
constexpr double kUneven = 0.02;    // metres: what is higher under a sole is an edge
constexpr double kShortSole = 0.1;  // metres, where the ball is not known
constexpr int kRounds = 8;          // of the search for the ball

Vec3 ahead(double heading) {
  return {std::sin(heading), 0, std::cos(heading)};
}

// Nothing to step on at (x, z) from a height of `from` metres: too high, or not there.
Error no_ground(const Terrain& ground, int number, double x, double z, double from) {
  const auto above = ground.at(x, z);
  if (above) {
    return {
        "walk-too-high",
        fmt::format("print {}: the ground at x {} m, z {} m is {} m higher than the other foot",
                    number + 1, readable(x, 4), readable(z, 4), readable(above->height - from, 3)),
        "lead the way around it, or put steps before it"};
  }
  return {"walk-ground",
          fmt::format("print {}: there is no ground at x {} m, z {} m", number + 1, readable(x, 4),
                      readable(z, 4)),
          "move the print, or give a larger ground"};
}

// Where the ground is no plane, the sole lies in the plane that is nearest to it under the four
// corners (least squares), as a shoe does, rather than on the line from heel to ball. Not over
// edges.
template <typename HeightAt>
void lie_on_corners(double length, double width, const HeightAt& height_at, GroundedPrint& print) {
  const Vec3 way = ahead(print.heading);
  for (int round = 0; round < kRounds; ++round) {
    const double level = length * std::hypot(print.forward.x(), print.forward.z());
    // The corners of the sole as it lies: rolled, they are nearer to each other.
    const Vec3 across = 0.5 * width * print.up.cross(print.forward);
    double heel = 0, ball = 0, roll = 0;
    for (const double side : {1.0, -1.0}) {
      const auto at_heel = height_at(print.heel + side * across);
      const auto at_ball = height_at(print.heel + level * way + side * across);
      if (!at_heel || !at_ball) return;
      heel += 0.5 * *at_heel;
      ball += 0.5 * *at_ball;
      roll += side * 0.5 * (*at_heel + *at_ball);
    }
    if (std::abs(heel - print.heel.y()) > kUneven) return;
    print.heel.y() = heel;
    print.forward = (level * way + Vec3(0, ball - heel, 0)).normalized();
    print.up = print.forward.cross(Vec3(2 * across.x(), roll, 2 * across.z())).normalized();
  }
}

}  // namespace

std::optional<GroundPoint> ground_near(const Terrain& ground, double x, double z, double from,
                                       double leg_length) {
  return ground.at(x, z, from + kStep * leg_length);
}

Result<GroundedPrint> set_on_ground(const Print& print, int number, const Walker& walker,
                                    const Terrain& ground, double from) {
  const Leg& leg = walker.leg(print.side);
  GroundedPrint result;
  result.side = print.side;
  result.heading = print.heading;
  const auto at_heel = ground_near(ground, print.x, print.z, from, leg.length);
  if (!at_heel && !print.height) return no_ground(ground, number, print.x, print.z, from);
  const double height = print.height ? *print.height : at_heel->height;
  result.heel = {print.x, height, print.z};
  const Vec3 way = ahead(print.heading), left = {way.z(), 0, -way.x()};
  // A print with a height of its own lies level where the ground has another height.
  const double raised = print.height && at_heel ? height - at_heel->height : 0;
  const auto height_at = [&](const Vec3& point) -> std::optional<double> {
    if (print.height && (!at_heel || std::abs(raised) > 0.01)) return height;
    const auto found = ground_near(ground, point.x(), point.z(), height, 0.5 * leg.length);
    if (!found) return {};
    return found->height + raised;
  };
  const double length = leg.sole.length > 0 ? leg.sole.length : kShortSole;
  double level = length;
  for (int round = 0; round < kRounds; ++round) {
    auto ball = height_at(result.heel + level * way);
    if (!ball) {
      const Vec3 there = result.heel + level * way;
      const auto above = ground.at(there.x(), there.z());
      if (!above) return no_ground(ground, number, there.x(), there.z(), height);
      ball = above->height;
    }
    const double slope = std::atan2(*ball - height, level);
    if (std::abs(slope) > kSteepest) {
      return Error("walk-too-steep",
                   fmt::format("print {}: between heel and ball the ground {} by {} cm, too steep "
                               "to stand on",
                               number + 1, slope > 0 ? "rises" : "falls",
                               readable(100 * std::abs(*ball - height), 3)),
                   "move the print off the edge, or onto flatter ground");
    }
    result.forward = (level * way + Vec3(0, *ball - height, 0)).normalized();
    level = length * std::hypot(result.forward.x(), result.forward.z());
  }
  // Across the foot as along it: what is too steep under heel and ball alike is no edge.
  const auto at_ball = ground_near(ground, result.heel.x() + level * way.x(),
                                   result.heel.z() + level * way.z(), height, leg.length);
  if (at_heel && at_ball &&
      std::max(at_heel->normal.y(), at_ball->normal.y()) < std::cos(kSteepest)) {
    return Error("walk-too-steep",
                 fmt::format("print {}: the ground is {}° steep", number + 1,
                             readable(std::acos(at_heel->normal.y()) / kRadiansPerDegree, 3)),
                 "lead the way over flatter ground");
  }
  double rise = 0;
  int pairs = 0;
  for (const double along : {0.0, level}) {
    const Vec3 centre = result.heel + along * way;
    const auto a = height_at(centre + 0.5 * walker.sole_width * left);
    const auto b = height_at(centre - 0.5 * walker.sole_width * left);
    if (!a || !b || std::abs(*a - *b) > walker.sole_width * std::tan(kMaxRoll)) continue;
    rise += *a - *b;
    ++pairs;
  }
  const double lateral = pairs > 0 ? rise / (pairs * walker.sole_width) : 0;
  result.up = result.forward.cross(left + Vec3(0, lateral, 0)).normalized();
  if (pairs == 2 && at_heel) lie_on_corners(length, walker.sole_width, height_at, result);
  return result;
}

namespace {

// Of the leg's length (thigh and shank).
constexpr double kLongest = 1.3;
// In flight: 2.44 m on average in the 100 m record of 2009 (41 steps), on legs of about 0.95 m.
constexpr double kLongestRun = 2.6;
constexpr double kHighest = 0.55;
constexpr double kWall = 0.6;
constexpr double kCrossing = 0.25;  // behind or before the stance foot

constexpr double kMaxTurnOut = 100 * kRadiansPerDegree, kMaxTurnIn = 60 * kRadiansPerDegree;
constexpr int kSamples = 24;  // of the way, when looking for walls

std::string metres(double value) {
  return readable(value, 3) + " m";
}

// Nothing solid between where the body is before the step and after it, up to the head, and nothing
// that the swing foot cannot be lifted over.
Status check_way(const GroundedPrint& from, const GroundedPrint& stance, const GroundedPrint& to,
                 int number, double leg, const Terrain& ground) {
  const double top = std::max({from.heel.y(), stance.heel.y(), to.heel.y()});
  const auto wall = [&](const Vec3& at) {
    return Error("walk-wall",
                 fmt::format("print {}: a wall is in the way at x {} m, z {} m", number + 1,
                             readable(at.x(), 3), readable(at.z(), 3)),
                 "lead the way around it");
  };
  for (const GroundedPrint* start : {&from, &stance}) {
    for (int i = 1; i < kSamples; ++i) {
      const Vec3 point = start->heel + (to.heel - start->heel) * (double(i) / kSamples);
      // Higher than a step, and nothing to walk on below it.
      const auto found = ground.at(point.x(), point.z());
      if (!found || found->height < top + kWall * leg) continue;
      if (!ground.at(point.x(), point.z(), top + kWall * leg)) return wall(point);
    }
  }
  const Vec3 before = 0.5 * (from.heel + stance.heel), after = 0.5 * (stance.heel + to.heel);
  for (const double height : {0.8, 1.2, 1.6, 1.9}) {  // of the leg
    const Vec3 start(before.x(), top + height * leg, before.z());
    const Vec3 end(after.x(), top + height * leg, after.z());
    if (ground.is_blocked(start, end)) return wall(after);
  }
  return {};
}

// Whether the soles of both feet, half as wide as they are, overlap: rectangles that no line along
// a side of one of them separates.
bool overlap(const GroundedPrint& one, const GroundedPrint& other, const Walker& walker) {
  const auto sole = [&](const GroundedPrint& print) {
    const double length = walker.leg(print.side).sole.length;
    const Vec2 along(std::sin(print.heading), std::cos(print.heading));
    const Vec2 across = 0.25 * walker.sole_width * Vec2(along.y(), -along.x());
    const Vec2 heel(print.heel.x(), print.heel.z());
    const Vec2 toes = heel + (length > 0 ? 1.3 * length : 0.2) * along;
    return std::array<Vec2, 4>{heel - across, heel + across, toes + across, toes - across};
  };
  const std::array<Vec2, 4> a = sole(one), b = sole(other);
  for (const auto& rectangle : {a, b}) {
    for (const Vec2& side :
         {Vec2(rectangle[1] - rectangle[0]), Vec2(rectangle[2] - rectangle[1])}) {
      const auto extent = [&](const std::array<Vec2, 4>& corners) {
        double least = side.dot(corners[0]), most = least;
        for (const Vec2& corner : corners) {
          least = std::min(least, side.dot(corner));
          most = std::max(most, side.dot(corner));
        }
        return std::pair(least, most);
      };
      const auto [low, high] = extent(a);
      const auto [from, to] = extent(b);
      if (high <= from || to <= low) return false;
    }
  }
  return true;
}

}  // namespace

StepShape shape_of(const GroundedPrint& stance, const GroundedPrint& to, double toe_out) {
  const double side = to.side == FootSide::left ? 1 : -1;
  const double toes = stance.facing - side * toe_out;
  const Vec3 way = to.heel - stance.heel;
  const Vec3 ahead(std::sin(toes), 0, std::cos(toes)), left(ahead.z(), 0, -ahead.x());
  const double turn = side * wrapped(to.facing - stance.facing);
  return {way.dot(ahead), side * way.dot(left), way.y(), turn + 2 * toe_out, turn};
}

Status check_reach(const GroundedPrint& from, const GroundedPrint& stance, const GroundedPrint& to,
                   int number, const Walker& walker, const Terrain& ground) {
  const double leg = walker.leg(to.side).length;
  const StepShape shape = shape_of(stance, to, 0);
  const auto refuse = [&](const char* code, const std::string& what, const std::string& hint) {
    return Error(code, fmt::format("print {}: {}", number + 1, what), hint);
  };
  const double far = std::hypot(shape.along, shape.across);
  const double longest = (walker.runs ? kLongestRun : kLongest) * leg;
  if (far > longest) {
    return refuse(
        "walk-too-long",
        fmt::format("the step is {} long, this walker can do {}", metres(far), metres(longest)),
        "put prints between, or use --adapt");
  }
  if (std::abs(shape.up) > kHighest * leg) {
    return refuse(
        "walk-too-high",
        fmt::format("the step goes {} by {}, this walker can do {}", shape.up > 0 ? "up" : "down",
                    metres(std::abs(shape.up)), metres(kHighest * leg)),
        "put prints between, or use --adapt");
  }
  const double turn = (to.side == FootSide::left ? 1 : -1) * wrapped(to.heading - stance.heading);
  if (turn > kMaxTurnOut || turn < -kMaxTurnIn) {
    return refuse("walk-heading",
                  fmt::format("the foot turns by {}° against the other one",
                              readable(std::abs(turn) / kRadiansPerDegree, 3)),
                  "turn in several steps, or use --adapt");
  }
  if (overlap(stance, to, walker) || shape.across < -kCrossing * leg) {
    return refuse("walk-crossing",
                  shape.across < -kCrossing * leg
                      ? fmt::format("the legs would cross by {}", metres(-shape.across))
                      : "the foot would step on the other one",
                  "move the print to its own side, or use --adapt");
  }
  return check_way(from, stance, to, number, leg, ground);
}

}  // namespace krok::gait
