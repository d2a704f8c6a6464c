#include "gait/plan_prints.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/numbers.h"
#include "gait/slope_gait_internal.h"
#include "math/window.h"

namespace krok::gait {

namespace {

// Whether a sole lies on one surface.

enum class SolePlace : unsigned char {
  whole,             // the sole lies on one surface
  heel_and_ball,     // the toes stand out over a lower edge or a hole
  midfoot_and_ball,  // the heel does
  none               // an edge between heel and ball, or something in the toes' way
};

struct SoleGround {
  SolePlace place = SolePlace::none;
  double height = 0;  // of the surface, metres: under the heel, or midfoot
};

constexpr double kSoleSample = 0.01;   // metres along the sole
constexpr double kSoleEdge = 0.025;    // metres from sample to sample: steeper than can be stood on
constexpr double kSoleMargin = 0.005;  // metres between heel or ball and an edge
constexpr double kMidfoot = 0.4;       // of the length from heel to ball
constexpr double kSteepAcross = 0.9;   // height by width, the tangent of 42 degrees
constexpr double kOverhead = 0.4;      // metres: what is higher is another storey

// Samples the ground under the part of a sole that begins `from` metres before the heel. `near` is
// the height of the ground thereabouts: surfaces far above it are another storey.
SoleGround ground_ahead_of(double from, const Print& print, double near, const Terrain& ground,
                           const PlanOptions& options) {
  const Vec2 ahead(std::sin(print.heading), std::cos(print.heading));
  const Vec2 left(ahead.y(), -ahead.x());
  const auto at_heel =
      ground.at(print.x + from * ahead.x(), print.z + from * ahead.y(), near + kOverhead);
  if (!at_heel) return {};
  SoleGround result{SolePlace::whole, at_heel->height};
  const double half = 0.5 * options.sole_width;
  std::array<double, 3> last = {at_heel->height, at_heel->height, at_heel->height};
  bool first = true;
  const double end = options.heel_to_toes;
  const int samples = static_cast<int>(std::ceil((end - from + kSoleMargin) / kSoleSample));
  for (int i = 0; i <= samples; ++i) {
    const double along = std::min(from + i * kSoleSample - kSoleMargin, end);
    std::array<double, 3> heights{};
    double edge = 0;  // 0: none, otherwise up or down
    for (std::size_t line = 0; line < 3; ++line) {
      // Toes are round: half as wide at the tip.
      const double narrow = along > options.heel_to_ball ? 0.5 : 1;
      const double across = (static_cast<double>(line) - 1) * half * narrow;
      const double x = print.x + along * ahead.x() + across * left.x();
      const double z = print.z + along * ahead.y() + across * left.y();
      const auto found = ground.at(x, z, last[line] + kOverhead);
      if (!found) {
        if (edge == 0) edge = -1;
        continue;
      }
      heights[line] = found->height;
      const double change = found->height - last[line];
      if (!first && std::abs(change) > kSoleEdge && edge <= 0) edge = change;
    }
    if (edge == 0 && std::abs(heights[2] - heights[0]) > kSteepAcross * options.sole_width) {
      edge = 1;
    }
    if (edge != 0) {
      const bool toes = along > options.heel_to_ball + kSoleMargin;
      result.place = toes && edge < 0 ? SolePlace::heel_and_ball : SolePlace::none;
      return result;
    }
    last = heights;
    first = false;
  }
  return result;
}

SoleGround ground_under_sole(const Print& print, double near, const Terrain& ground,
                             const PlanOptions& options) {
  const SoleGround all = ground_ahead_of(0, print, near, ground, options);
  if (all.place != SolePlace::none) return all;
  // Up stairs that are shorter than the sole, the heel stands out over the tread below.
  SoleGround front = ground_ahead_of(kMidfoot * options.heel_to_ball, print, near, ground, options);
  if (front.place != SolePlace::whole) return all;
  const auto at_heel = ground.at(print.x, print.z, near + kOverhead);
  if (at_heel && at_heel->height > front.height - kSoleEdge) return all;
  front.place = SolePlace::midfoot_and_ball;
  return front;
}

constexpr double kPlanGrid = 0.005;     // metres, of places for feet on uneven ground
constexpr double kMaxPlanPlaces = 5e6;  // of them
constexpr double kGradeReach = 1;       // metres on either side, over which slopes are averaged
constexpr double kSteepNormal = 0.5;    // least height of a normal: what is steeper is a wall
constexpr double kStorey = 0.6;         // metres: what is higher than this is overhead
constexpr double kEndRange = 0.4;       // metres by which the last prints may be short of the end
constexpr double kBesideRange = 0.3;    // metres by which one may be before the other
constexpr double kBesideCost = 2;       // per metre of that, and of the rise from one to the other
// Of a step's length squared, where toes or heel stand out.
constexpr double kToesOutCost = 0.3, kHeelOutCost = 0.5;
constexpr double kShortOfEndCost = 4;    // per metre
constexpr double kStandingWidth = 1.25;  // of the sole's, from heel to heel
// People shorten steps that go up or down, and the first one out of standing.
constexpr double kTooHighToStride = 0.3;  // metres
constexpr double kMinOfUsual = 0.4, kFirstOfUsual = 0.8;
constexpr double kGentleTurn = 0.15;  // radians a step
constexpr double kNever = std::numeric_limits<double>::infinity();

FootSide other_foot(FootSide side) {
  return side == FootSide::left ? FootSide::right : FootSide::left;
}

Status check_plan_options(const PlanOptions& options) {
  const auto wrong = [](const char* what) {
    return Error("plan-options", what, "check step length, width and turn");
  };
  const auto is_step = [&](double length) {
    return options.min_step <= length && length <= options.max_step;
  };
  if (!(options.min_step > 0.01 && is_step(options.step_length) && options.max_step < 10 &&
        std::ranges::all_of(options.step_lengths, is_step))) {
    return wrong(
        "steps must be above 1 cm, the least at most as long as asked, and the most at least");
  }
  if (!(options.step_width >= 0 && options.step_width < 2))
    return wrong("the step width is not 0 to 2 m");
  if (!(options.max_turn > 0.01 && options.max_rise > 0))
    return wrong("turn and rise must be above 0");
  if (!(options.heel_to_ball >= 0 && options.heel_to_toes >= options.heel_to_ball &&
        options.sole_width >= 0 && options.heel_to_toes < 1)) {
    return wrong("the sole's measures are not those of a foot");
  }
  return {};
}

// A micrometre and a millionth of a degree, as files have them, so that prints that were saved and
// read again are the same.
Print rounded(Print print) {
  constexpr double kUnits = 1e6;
  print.x = std::round(print.x * kUnits) / kUnits;
  print.z = std::round(print.z * kUnits) / kUnits;
  const double degrees = std::remainder(print.heading, 2 * kPi) / kRadiansPerDegree;
  print.heading = std::round(degrees * kUnits) / kUnits * kRadiansPerDegree;
  if (print.time) print.time = std::round(*print.time * kUnits) / kUnits;
  return print;
}

// A foot on a place of the grid.
struct PlaceState {
  SoleGround sole;
  double cost = kNever;  // of the steps up to here
  int from = -1;         // place of the foot before
};
using PlaceStates = std::array<std::vector<PlaceState>, 2>;  // [FootSide][place]

class PrintPlanner {
 public:
  PrintPlanner(const Path& path, const Terrain& ground, const PlanOptions& options)
      : path_(path), ground_(ground), options_(options) {}

  Result<PlannedPrints> plan() {
    if (Status status = check_plan_options(options_); !status) return status.error();
    if (Status status = follow_ground(); !status) return status.error();
    count_steps();
    std::vector<double> places = even_places();
    PlannedPrints result;
    if (!all_fit(places)) {
      auto fitted = fitted_places();
      if (!fitted) return fitted.error();
      places = *std::move(fitted);
      result.fitted_to_ground = true;
    }
    result.prints = prints_at(places);
    return result;
  }

 private:
  // The places of prints below are along the path, without the first two; the last print is set
  // beside the one before it.

  Status follow_ground();
  // Steps from the begin to places every spacing_: where the way is straight, one in step_length,
  // downhill a little more.
  void count_steps();
  double step_length_at(double part) const;  // of the path
  double ground_near(double length) const;
  double length_of(std::size_t place) const {
    return std::min(static_cast<double>(place) * spacing_, path_.length());
  }
  std::vector<double> even_places() const;
  Print print_at(double length, FootSide side) const;
  bool all_fit(const std::vector<double>& places) const;
  PlaceStates possible_places() const;
  // Sets the costs of all places; the farthest that can be reached.
  std::size_t find_ways(PlaceStates& states) const;
  struct End {
    double cost = kNever;
    std::size_t place = 0, side = 0;
    std::size_t beside = 0;  // place of the other foot
  };
  End best_end(const PlaceStates& states) const;
  Result<std::vector<double>> fitted_places() const;
  std::vector<Print> prints_at(const std::vector<double>& places) const;

  const Path& path_;
  const Terrain& ground_;
  const PlanOptions& options_;
  double spacing_ = kPlanGrid;
  std::vector<double> heights_;  // of the ground under the path, at i * spacing_
  std::vector<double> slopes_;   // of the ground along it, tangents, 0 on treads; the same
  std::vector<double> steps_;    // the same
  double straight_steps_ = 0;    // all, if the path were straight
};

Status PrintPlanner::follow_ground() {
  const PathPlace begin = path_.at(0);
  // Prints stand beside the path: over a gap in the middle, the ground last seen counts.
  auto found = ground_.at(begin.x, begin.z);
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    const Print print = print_at(0, side);
    if (!found) found = ground_.at(print.x, print.z);
  }
  if (!found) {
    return Error("plan-ground",
                 fmt::format("there is no ground at the begin of the path, x {} m, z {} m",
                             readable(begin.x, 4), readable(begin.z, 4)),
                 "move the path, or give a larger ground");
  }
  spacing_ = std::max(kPlanGrid, path_.length() / kMaxPlanPlaces);
  heights_.resize(static_cast<std::size_t>(std::ceil(path_.length() / spacing_)) + 1);
  slopes_.assign(heights_.size(), 0);
  double height = found->height;
  for (std::size_t i = 0; i < heights_.size(); ++i) {
    const PathPlace place = path_.at(static_cast<double>(i) * spacing_);
    const auto here = ground_.at(place.x, place.z, height + kStorey);
    if (here && here->height > height - 2 * kStorey) height = here->height;
    heights_[i] = height;
    if (!here) continue;
    const Vec3 way(std::sin(place.heading), 0, std::cos(place.heading));
    slopes_[i] = -here->normal.dot(way) / std::max(here->normal.y(), kSteepNormal);
  }
  return {};
}

void PrintPlanner::count_steps() {
  const auto reach = static_cast<int>(std::lround(kGradeReach / spacing_));
  const std::vector<double> slopes = mean_within(slopes_, reach);
  steps_.assign(heights_.size(), 0);
  for (std::size_t i = 1; i < steps_.size(); ++i) {
    const double width = std::min(spacing_, path_.length() - static_cast<double>(i - 1) * spacing_);
    const double turn = std::abs(path_.at(static_cast<double>(i) * spacing_).heading -
                                 path_.at(static_cast<double>(i - 1) * spacing_).heading);
    const double grade = std::atan(slopes[i]);
    const double usual = step_length_at(static_cast<double>(i) / double(steps_.size() - 1));
    const double straight = width / (usual * slope_gait(grade, grade).length);
    straight_steps_ += straight;
    steps_[i] = steps_[i - 1] + std::max(straight, turn / options_.max_turn);
  }
}

double PrintPlanner::step_length_at(double part) const {
  const std::vector<double>& lengths = options_.step_lengths;
  if (lengths.empty()) return options_.step_length;
  const double place = part * static_cast<double>(lengths.size() - 1);
  const std::size_t before = std::min(static_cast<std::size_t>(place), lengths.size() - 1);
  const std::size_t after = std::min(before + 1, lengths.size() - 1);
  return std::lerp(lengths[before], lengths[after], place - static_cast<double>(before));
}

double PrintPlanner::ground_near(double length) const {
  return heights_[std::min(static_cast<std::size_t>(std::lround(length / spacing_)),
                           heights_.size() - 1)];
}

std::vector<double> PrintPlanner::even_places() const {
  const double all = steps_.back();
  double count = std::max(1.0, std::round(all));
  // Fewer steps than counted are longer ones, and turn more where that is what limits them.
  const bool turns = all > straight_steps_ + 0.01;
  if (turns || all / count * options_.step_length > options_.max_step) {
    count = std::ceil(all - 1e-9);
  }
  std::vector<double> places;
  std::size_t i = 0;
  for (int k = 1; k < static_cast<int>(count); ++k) {
    const double wanted = all * k / count;
    while (i + 2 < steps_.size() && steps_[i + 1] < wanted) ++i;
    const double part = (wanted - steps_[i]) / std::max(steps_[i + 1] - steps_[i], 1e-12);
    places.push_back((static_cast<double>(i) + std::clamp(part, 0.0, 1.0)) * spacing_);
  }
  places.insert(places.end(), 2, path_.length());
  return places;
}

Print PrintPlanner::print_at(double length, FootSide side) const {
  const PathPlace place = path_.at(length);
  // Feet of people who walk on a line stand beside each other all the same.
  const bool stands = length <= 0 || length >= path_.length();
  double width = stands ? std::max(options_.step_width, kStandingWidth * options_.sole_width)
                        : options_.step_width;
  // In sharp bends feet would step on each other's toes.
  const double bend = std::abs(place.curvature);
  const double turn = std::min(bend * options_.step_length, options_.max_turn);
  width += options_.heel_to_toes * std::max(0.0, std::sin(turn) - std::sin(kGentleTurn));
  const double out = ((side == FootSide::left) != options_.backward ? 0.5 : -0.5) * width;
  Print print;
  print.side = side;
  print.x = place.x + out * std::cos(place.heading);
  print.z = place.z - out * std::sin(place.heading);
  print.heading = place.heading + (options_.backward ? kPi : 0) +
                  options_.toe_out[static_cast<std::size_t>(side)];
  if (length > 0) print.time = place.time;
  return print;
}

bool PrintPlanner::all_fit(const std::vector<double>& places) const {
  FootSide side = other_foot(options_.first);
  const auto under = [&](double length, FootSide foot) {
    return ground_under_sole(print_at(length, foot), ground_near(length), ground_, options_);
  };
  SoleGround last = under(0, side);
  if (last.place != SolePlace::whole || under(0, options_.first).place != SolePlace::whole) {
    return false;
  }
  for (const double place : places) {
    side = other_foot(side);
    const SoleGround next = under(place, side);
    if (next.place != SolePlace::whole) return false;
    if (std::abs(next.height - last.height) > options_.max_rise) return false;
    last = next;
  }
  return true;
}

PlaceStates PrintPlanner::possible_places() const {
  PlaceStates states;
  for (const FootSide side : {FootSide::left, FootSide::right}) {
    auto& of_side = states[static_cast<std::size_t>(side)];
    of_side.resize(steps_.size());
    for (std::size_t i = 0; i < of_side.size(); ++i) {
      const double length = length_of(i);
      of_side[i].sole =
          ground_under_sole(print_at(length, side), ground_near(length), ground_, options_);
    }
  }
  return states;
}

std::size_t PrintPlanner::find_ways(PlaceStates& states) const {
  const auto reach = static_cast<std::size_t>(std::ceil(options_.max_step / spacing_));
  std::size_t farthest = 0;
  for (std::size_t i = 1; i < steps_.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      PlaceState& state = states[side][i];
      if (state.sole.place == SolePlace::none) continue;
      const double out = state.sole.place == SolePlace::whole           ? 0
                         : state.sole.place == SolePlace::heel_and_ball ? kToesOutCost
                                                                        : kHeelOutCost;
      for (std::size_t j = i > reach ? i - reach : 0; j < i; ++j) {
        const PlaceState& before = states[1 - side][j];
        const double step = length_of(i) - length_of(j);
        if (before.cost == kNever || step < options_.min_step || step > options_.max_step ||
            std::abs(state.sole.height - before.sole.height) > options_.max_rise) {
          continue;
        }
        const double rise = std::abs(state.sole.height - before.sole.height);
        const double usual =
            std::max(kMinOfUsual, 1 - rise / kTooHighToStride) * (j == 0 ? kFirstOfUsual : 1);
        const double off = steps_[i] - steps_[j] - usual;
        const double cost = before.cost + off * off + out;
        if (cost >= state.cost) continue;
        state.cost = cost;
        state.from = static_cast<int>(j);
        farthest = i;
      }
    }
  }
  return farthest;
}

PrintPlanner::End PrintPlanner::best_end(const PlaceStates& states) const {
  End best;
  const auto range = static_cast<std::size_t>(kBesideRange / spacing_);
  for (std::size_t i = steps_.size(); i-- > 1;) {
    const double missing = path_.length() - length_of(i);
    if (missing > kEndRange) break;
    for (std::size_t side = 0; side < 2; ++side) {
      const PlaceState& last = states[side][i];
      const double cost = last.cost + kShortOfEndCost * missing;
      if (!(cost < best.cost)) continue;
      // Where stairs are crossed at an angle, both feet may not find room side by side.
      for (std::size_t k = i > range ? i - range : 1; k < std::min(i + range, steps_.size()); ++k) {
        const SoleGround& beside = states[1 - side][k].sole;
        const double rise = std::abs(beside.height - last.sole.height);
        if (beside.place == SolePlace::none || rise > options_.max_rise) continue;
        const double apart = std::abs(length_of(k) - length_of(i));
        const double both = cost + kBesideCost * (apart + rise);
        if (both < best.cost) best = {both, i, side, k};
      }
    }
  }
  return best;
}

// The cheapest sequence of places by dynamic programming: a state is a foot on a place of the grid.
Result<std::vector<double>> PrintPlanner::fitted_places() const {
  PlaceStates states = possible_places();
  for (const auto& side : states) {
    if (side[0].sole.place != SolePlace::none) continue;
    const PathPlace begin = path_.at(0);
    return Error(
        "plan-ground",
        fmt::format("a foot would stand on an edge or over a hole at the begin of the path, "
                    "x {} m, z {} m",
                    readable(begin.x, 4), readable(begin.z, 4)),
        "begin the path elsewhere");
  }
  states[static_cast<std::size_t>(other_foot(options_.first))][0].cost = 0;
  const std::size_t farthest = find_ways(states);
  const End end = best_end(states);
  if (end.cost == kNever) {
    const PathPlace place = path_.at(length_of(farthest));
    const double next = std::min(length_of(farthest) + options_.max_step, path_.length());
    if (const PathPlace ahead = path_.at(next); !ground_.at(ahead.x, ahead.z)) {
      return Error(
          "plan-ground",
          fmt::format("the ground ends {} to {} m along the path of {} m: there is none at "
                      "x {} m, z {} m",
                      readable(length_of(farthest), 3), readable(next, 3),
                      readable(path_.length(), 3), readable(ahead.x, 3), readable(ahead.z, 3)),
          "give a larger ground, or a path that stays on it");
    }
    return Error(
        "plan-ground",
        fmt::format(
            "no place for a foot follows x {} m, z {} m ({} m along the path): within {} to "
            "{} m a sole would lie across an edge or over a hole, or the step be higher than "
            "{} m",
            readable(place.x, 4), readable(place.z, 4), readable(length_of(farthest), 4),
            readable(options_.min_step), readable(options_.max_step), readable(options_.max_rise)),
        "lead the path elsewhere, or give footprints");
  }
  std::vector<double> places;
  std::size_t side = end.side;
  for (std::size_t i = end.place; i > 0; side = 1 - side) {
    places.push_back(length_of(i));
    i = static_cast<std::size_t>(states[side][i].from);
  }
  std::reverse(places.begin(), places.end());
  places.push_back(length_of(end.beside));
  return places;
}

std::vector<Print> PrintPlanner::prints_at(const std::vector<double>& places) const {
  std::vector<Print> prints = {print_at(0, options_.first),
                               print_at(0, other_foot(options_.first))};
  FootSide side = options_.first;
  for (const double place : places) {
    prints.push_back(print_at(place, side));
    side = other_foot(side);
  }
  // The last foot is set beside the other one: later, but the path does not say when.
  prints.back().time.reset();
  std::size_t index = 0;
  for (Print& print : prints) {
    const double length = index < 2 ? 0 : places[index - 2];
    const double near = ground_near(length);
    print = rounded(print);
    // Where something is overhead, or the heel stands out, the print says how high it is.
    const auto top = ground_.at(print.x, print.z);
    const SoleGround sole = ground_under_sole(print, near, ground_, options_);
    if (sole.place == SolePlace::midfoot_and_ball ||
        (top && sole.place != SolePlace::none && top->height > sole.height + 1e-9)) {
      print.height = sole.height;
    }
    ++index;
  }
  return prints;
}

}  // namespace

Result<PlannedPrints> plan_prints(const Path& path, const Terrain& ground,
                                  const PlanOptions& options) {
  return PrintPlanner(path, ground, options).plan();
}

}  // namespace krok::gait
