#include "gait/usual_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "gait/walker_internal.h"

namespace krok::gait {

namespace {

constexpr double kLevelStep = 0.05;    // metres: what rises less is a step on level ground
constexpr double kStraightStep = 0.2;  // radians: what turns less goes straight on
constexpr double kMinStep = 0.05;      // metres
constexpr double kToesPerBall = 1.45;  // from heel to toes, of heel to ball
constexpr double kUnknownSole = 0.16;  // metres from heel to ball, where the ball is not known
constexpr double kMoreLength = 0.03;   // metres beyond the longest example

// The mean of the steps that go straight on over level ground, if there are any: in steps that all
// turn to one side, toes would seem to point to that side.
FoundStep mean_of_steps(const StepLibrary& steps) {
  std::array<FoundStep, 3> sums;  // level and straight, level, all
  std::array<int, 3> counts{};
  for (const FoundStep& step : steps.found_steps()) {
    const bool is_level = std::abs(step.up) < kLevelStep;
    const bool is_straight = std::abs(step.turn - 2 * steps.toe_out()) < kStraightStep;
    for (std::size_t i = is_level ? (is_straight ? 0 : 1) : 2; i < sums.size(); ++i) {
      sums[i].along += step.along;
      sums[i].across += step.across;
      sums[i].turn += step.turn;
      ++counts[i];
    }
  }
  std::size_t i = 0;
  while (i < 2 && counts[i] == 0) ++i;
  const double count = counts[i];
  // If all steps turn, their toes show the turn.
  const double turn = i == 0 ? sums[i].turn / count : 2 * steps.toe_out();
  return {sums[i].along / count, sums[i].across / count, 0, turn};
}

}  // namespace

Result<PlanOptions> usual_steps(std::span<const StepLibrary> libraries) {
  const StepLibrary& main = main_library(libraries);
  PlanOptions options;
  const FoundStep usual = mean_of_steps(main);
  // Prints are planned along the way, which lies between the directions of the toes.
  const double out = 0.5 * usual.turn;
  options.step_length = usual.along * std::cos(out) + usual.across * std::sin(out);
  if (std::abs(options.step_length) < kMinStep) {
    return Error("walk-library",
                 fmt::format("the steps of {} go neither forward nor backward, so that none can be "
                             "planned along a path",
                             main.name()),
                 "give footprints, or a library of walks or of steps backward");
  }
  options.backward = options.step_length < 0;
  options.step_length = std::abs(options.step_length);
  const double ahead = options.backward ? -1 : 1;
  double longest = 0, max_turn = 0;
  for (const StepLibrary& one : libraries) {
    if (one.kind() != StepKind::walk) continue;
    const parametric::Library& library = one.library();
    for (std::size_t d = 0; d < library.parameters.size(); ++d) {
      const auto quantity = library.parameters[d].quantity;
      for (const parametric::Example& example : library.examples) {
        const double value = example.parameters[d];
        if (quantity == parametric::Quantity::step_length)
          longest = std::max(longest, ahead * value);
        if (quantity == parametric::Quantity::step_turn) max_turn = std::max(max_turn, value);
      }
    }
  }
  options.step_width = std::max(0.0, usual.across * std::cos(out) - usual.along * std::sin(out));
  const double toe_out = main.toe_out();
  options.toe_out = {toe_out, -toe_out};
  options.max_step = std::max(longest, options.step_length) + kMoreLength;
  if (max_turn > 0.1) options.max_turn = max_turn;
  const auto walker = make_walker(libraries);
  if (!walker) return walker.error();
  const FootGeometry& sole = walker->leg(FootSide::left).sole;
  options.heel_to_ball = sole.length > 0 ? sole.length : kUnknownSole;
  options.heel_to_toes =
      sole.tip > 0 ? options.heel_to_ball + sole.tip : kToesPerBall * options.heel_to_ball;
  options.sole_width = walker->sole_width;
  options.min_step = std::min(options.min_step, options.step_length);
  return options;
}

}  // namespace krok::gait
