#include "gait/reach_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/numbers.h"
#include "motion/ground_frame.h"

namespace krok::gait {

namespace {

// Of the leg's length (thigh and shank).
constexpr double kLongest = 1.3;
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

// Whether the soles of both feet, half as wide as they are, lie on each other: rectangles that no
// line along a side of one of them parts.
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
  if (far > kLongest * leg) {
    return refuse("walk-too-long",
                  fmt::format("the step is {} long, this walker can do {}", metres(far),
                              metres(kLongest * leg)),
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
