#include "gait/plan_prints.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "core/numbers.h"
#include "gait/walker_internal.h"
#include "parametric/library.h"

namespace krok::gait {

namespace {

constexpr double kLevelStep = 0.05;    // metres: what rises less is a step on level ground
constexpr double kStraightStep = 0.2;  // radians: what turns less goes straight on
constexpr double kMinStep = 0.05;      // metres
constexpr double kToesPerBall = 1.45;  // from heel to toes, of heel to ball
constexpr double kUnknownSole = 0.16;  // metres from heel to ball, where the ball is not known
constexpr double kMoreLength = 0.03;   // metres beyond the longest example

bool is_straight(const StepLibrary& steps, const FoundStep& step) {
  return std::abs(step.turn - 2 * steps.toe_out()) < kStraightStep;
}

// Captures of steps that nearly all go straight on: before and after a turn people slow down.
std::set<std::string_view> straight_captures(const StepLibrary& steps) {
  constexpr double kNearlyAll = 0.75;
  std::map<std::string_view, std::pair<int, int>> counts;  // straight steps, all
  for (std::size_t e = 0; e < steps.found_steps().size(); ++e) {
    auto& [straight, all] = counts[parametric::capture_of(steps.library().examples[e].name)];
    straight += is_straight(steps, steps.found_steps()[e]) ? 1 : 0;
    ++all;
  }
  std::set<std::string_view> captures;
  for (const auto& [capture, count] : counts) {
    if (count.first >= kNearlyAll * count.second) captures.insert(capture);
  }
  return captures;
}

// The mean of the steps that go straight on over level ground, in captures that do if there are
// any: in steps that all turn to one side, toes would seem to point to that side.
FoundStep mean_of_steps(const StepLibrary& steps) {
  std::array<FoundStep, 4> sums;  // level and straight in straight captures; so in any; level; all
  std::array<int, 4> counts{};
  const std::set<std::string_view> captures = straight_captures(steps);
  for (std::size_t e = 0; e < steps.found_steps().size(); ++e) {
    if (!steps.in_style(e)) continue;
    const FoundStep& step = steps.found_steps()[e];
    const std::string_view capture = parametric::capture_of(steps.library().examples[e].name);
    const std::size_t first = std::abs(step.up) >= kLevelStep ? 3
                              : !is_straight(steps, step)     ? 2
                              : !captures.contains(capture)   ? 1
                                                              : 0;
    for (std::size_t i = first; i < sums.size(); ++i) {
      sums[i].along += step.along;
      sums[i].across += step.across;
      sums[i].turn += step.turn;
      ++counts[i];
    }
  }
  std::size_t i = 0;
  while (i < 3 && counts[i] == 0) ++i;
  const double count = counts[i];
  // If all steps turn, their toes show the turn.
  const double turn = i < 2 ? sums[i].turn / count : 2 * steps.toe_out();
  return {sums[i].along / count, sums[i].across / count, 0, turn};
}

// Along the way, which lies between the directions of the toes.
double length_along_way(const FoundStep& step, double out) {
  return std::abs(step.along * std::cos(out) + step.across * std::sin(out));
}

struct Pace {
  double length = 0, duration = 0;  // metres, seconds, of a step
  double speed() const { return length / duration; }
};

// Steps over the range of the examples' lengths, a centimetre apart.
std::vector<Pace> paces_of(const StepLibrary& steps) {
  constexpr double kPaceSpacing = 0.01, kAlike = 0.02;  // metres
  std::vector<Pace> examples;
  for (std::size_t i = 0; i < steps.found_steps().size(); ++i) {
    if (!steps.in_style(i)) continue;
    const std::vector<double>& times = steps.library().examples[i].keytimes;
    examples.push_back(
        {length_along_way(steps.found_steps()[i], steps.toe_out()), times.back() - times.front()});
  }
  const auto [least, most] = std::ranges::minmax(examples, {}, &Pace::length);
  std::vector<Pace> paces;
  const int count = static_cast<int>((most.length - least.length) / kPaceSpacing);
  for (int i = 0; i <= count; ++i) {
    Pace pace{least.length + i * kPaceSpacing, 0};
    double weights = 0;
    for (const Pace& example : examples) {
      const double apart = (example.length - pace.length) / kAlike;
      const double weight = 1 / ((1 + apart * apart) * (1 + apart * apart));
      pace.duration += weight * example.duration;
      weights += weight;
    }
    pace.duration /= weights;
    if (pace.length >= kMinStep) paces.push_back(pace);
  }
  return paces;
}

}  // namespace

Result<double> step_length_at_speed(std::span<const StepLibrary> libraries, double speed) {
  constexpr double kAllowed = 0.05;  // of the speed
  const auto off = [&](const Pace& pace) { return std::abs(pace.speed() - speed); };
  std::vector<Pace> all;
  for (const StepLibrary& library : libraries) {
    if (!library.is_middle()) continue;
    const std::vector<Pace> paces = paces_of(library);
    all.insert(all.end(), paces.begin(), paces.end());
  }
  const auto nearest = std::ranges::min_element(all, {}, off);
  std::string range;
  if (nearest != all.end()) {
    const auto [slowest, fastest] = std::ranges::minmax(all, {}, &Pace::speed);
    const bool between = slowest.speed() < speed && speed < fastest.speed();
    if (between || off(*nearest) <= kAllowed * speed) return nearest->length;
    range = fmt::format(": those of the libraries go at {} to {} m/s", readable(slowest.speed(), 3),
                        readable(fastest.speed(), 3));
  }
  return Error("walk-speed", fmt::format("no step goes at {} m/s{}", readable(speed, 3), range),
               "add a library of runs or of walks, or change the pace with --speed");
}

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
    if (!one.is_middle()) continue;
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
