#include "gait/step_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/text.h"
#include "math/window.h"
#include "motion/hips_root.h"

namespace krok::gait {

namespace {

constexpr double kClearly = 0.15;  // metres: steps forward or backward, not on the spot
constexpr std::size_t kShownStyles = 12;
constexpr double kMaxToeOut = kPi / 3;  // more is a step to the side

double heading_at(const parametric::Example& example, const parametric::FootShape& foot,
                  double time) {
  return parametric::print_at(foot, example.motion, time).heading;
}

// The toe-out of the walks that the steps were cut from, if it is known; otherwise half the angle
// between the feet in the median step.
double usual_toe_out(const parametric::Library& library) {
  const double left = library.foot(FootSide::left).toe_out;
  const double right = library.foot(FootSide::right).toe_out;
  if (left != 0 || right != 0) return 0.5 * (left - right);
  std::vector<double> turns;
  for (const parametric::Example& example : library.examples) {
    const double stance =
        heading_at(example, library.foot(library.stance()), example.keytimes.front());
    const double swing = heading_at(example, library.foot(library.swing), example.keytimes.back());
    turns.push_back((library.swing == FootSide::left ? 1 : -1) * wrapped(swing - stance));
  }
  return std::clamp(0.5 * upper_median(std::move(turns)), -kMaxToeOut, kMaxToeOut);
}

FoundStep step_of(const parametric::Library& library, const parametric::Example& example) {
  const Clip& clip = example.motion;
  const int frame = std::clamp(static_cast<int>(std::lround(example.keytimes.back() * clip.rate)),
                               0, clip.frame_count() - 1);
  std::vector<Transform> pose(static_cast<std::size_t>(clip.joint_count()));
  clip.get_pose(frame, pose);
  const parametric::FootShape& foot = library.foot(library.swing);
  const auto print = parametric::footprint(foot, pose[static_cast<std::size_t>(foot.joint)]);
  const double side = library.swing == FootSide::left ? 1 : -1;
  return {print.place.z(), side * print.place.x(), print.place.y(), side * print.heading};
}

std::optional<StepKind> kind_of(const std::vector<std::string>& times) {
  const auto named = [&](const char* name) {
    return std::ranges::find(times, name) != times.end();
  };
  if (times.front() == "stand" && times.back() == "stand_end") return StepKind::stand;
  if (times.front() == "stance_strike" && named("stance_off") && times.back() == "swing_strike") {
    return StepKind::run;
  }
  if (!named("swing_off") || !named("swing_strike")) return {};
  if (times.front() == "stand" && times.back() == "swing_strike") return StepKind::start;
  if (times.front() != "stance_strike") return {};
  if (times.back() == "stand") return StepKind::stop;
  if (times.back() == "swing_strike") return StepKind::walk;
  return {};
}

// First and last steps forward and backward have no blend between them: the body would go elsewhere
// than the feet.
Status check_direction(const StepLibrary& steps) {
  if (steps.kind() != StepKind::start && steps.kind() != StepKind::stop) return {};
  const auto goes = [&](double ahead) {
    return std::ranges::count_if(
        steps.found_steps(), [&](const FoundStep& step) { return ahead * step.along > kClearly; });
  };
  const auto forward = goes(1), backward = goes(-1);
  if (forward == 0 || backward == 0) return {};
  return Error("walk-library",
               fmt::format("the {} of the library go forward in {} and backward in {} examples",
                           steps.kind() == StepKind::start ? "starts" : "stops", forward, backward),
               "fit a library of each, and give the one that goes as the walk does");
}

}  // namespace

bool StepLibrary::take_style(std::string_view style) {
  const auto& examples = library().examples;
  const std::string wanted = ascii_lower(style);
  std::vector<std::uint8_t> taken(examples.size(), 0);
  const auto take = [&](auto&& is_taken) {
    std::ranges::transform(examples, taken.begin(), is_taken);
    return std::ranges::find(taken, 1) != taken.end();
  };
  const bool found =
      take([&](const auto& example) { return ascii_lower(example.style) == wanted; }) ||
      take([&](const auto& example) {
        return ascii_lower(parametric::capture_of(example.name)).find(wanted) != std::string::npos;
      });
  if (!found) return false;
  // How far toes point outwards is a part of the style. Steps that turn count alike for both.
  std::vector<double> all, own;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    all.push_back(found_steps_[i].turn);
    if (taken[i] != 0) own.push_back(found_steps_[i].turn);
  }
  toe_out_ = std::clamp(usual_toe_out(library()) + 0.5 * (median(own) - median(all)), -kMaxToeOut,
                        kMaxToeOut);
  in_style_ = std::move(taken);
  return true;
}

Status take_style(std::span<StepLibrary> libraries, std::string_view style) {
  bool found = false;
  std::vector<std::string> names;
  for (StepLibrary& library : libraries) {
    found = (library.take_style(style) && library.is_middle()) || found;
    for (const parametric::Example& example : library.library().examples) {
      std::string name = example.style;
      if (name.empty()) name = parametric::capture_of(example.name);
      if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
    }
  }
  if (found) return {};
  std::string some;
  for (std::size_t i = 0; i < std::min(names.size(), kShownStyles); ++i) {
    some += (i == 0 ? "" : ", ") + shown(names[i]);
  }
  return Error(
      "walk-style",
      fmt::format("no style is '{0}', and no capture's name contains '{0}'", shown(style)),
      fmt::format("the library has {}{}", some, names.size() > kShownStyles ? ", ..." : ""));
}

const StepLibrary& main_library(std::span<const StepLibrary> libraries) {
  for (const StepKind kind : {StepKind::walk, StepKind::run}) {
    const auto found = std::ranges::find(libraries, kind, &StepLibrary::kind);
    if (found != libraries.end()) return *found;
  }
  return libraries.front();
}

Result<StepLibrary> StepLibrary::create(std::string name, parametric::Library library,
                                        const rbf::WeightFunction& weights, const RoleMap& roles) {
  using parametric::Quantity;
  const auto measures = [&](Quantity quantity) {
    return std::ranges::any_of(library.parameters, [&](const parametric::Parameter& parameter) {
      return parameter.quantity == quantity;
    });
  };
  const auto kind = kind_of(library.keytimes);
  const bool is_middle = kind == StepKind::walk || kind == StepKind::run;
  if (!kind || (is_middle && !measures(Quantity::step_length))) {
    return Error(
        "walk-library",
        "this is no library of steps: walking needs the parameter step.length and the "
        "keytimes stance_strike, swing_off and swing_strike, running stance_off for swing_off",
        "krok-fit makes one with \"steps\": \"auto\", and runs, starts, stops and stands");
  }
  StepLibrary result;
  result.kind_ = *kind;
  result.name_ = std::move(name);
  result.roles_ = roles;
  auto mirrored = parametric::mirrored(library);
  if (!mirrored) return std::move(mirrored).error();
  const auto own = static_cast<std::size_t>(library.swing);
  result.own_ = library.swing;
  result.libraries_[own] = std::make_unique<const parametric::Library>(std::move(library));
  result.libraries_[1 - own] = std::make_unique<const parametric::Library>(*std::move(mirrored));
  for (std::size_t side = 0; side < 2; ++side) {
    auto synthesiser = parametric::Synthesiser::create(*result.libraries_[side], weights);
    if (!synthesiser) return std::move(synthesiser).error();
    result.synthesisers_[side] =
        std::make_unique<const parametric::Synthesiser>(*std::move(synthesiser));
  }
  for (const parametric::Example& example : result.library().examples) {
    result.found_steps_.push_back(step_of(result.library(), example));
  }
  if (Status status = check_direction(result); !status) return status.error();
  result.toe_out_ = usual_toe_out(result.library());
  return result;
}

}  // namespace krok::gait
