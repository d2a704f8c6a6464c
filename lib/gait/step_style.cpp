#include "gait/body_motion_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/index.h"
#include "core/text.h"
#include "math/hermite.h"

namespace krok::gait {

namespace {

// Costs of an example, metres: as far as joints are apart where two steps meet.
constexpr double kOfParameters = 5.0;    // for the square of a range of the parameters
constexpr double kOtherCapture = 0.015;  // than that of the step before
constexpr double kOtherFoot = 0.01;      // a mirror image
constexpr double kAgain = 0.04;  // for the step before with that foot, less for earlier ones
constexpr std::size_t kLastSteps = 6;
constexpr double kByChance = 0.008;       // at most
constexpr double kVelocityTime = 0.1;     // seconds: 1 m/s counts as 0.1 m
constexpr double kVelocityOver = 0.05;    // seconds over which a velocity is taken
constexpr double kNoStyle = 1e-6;         // sum of differences of weights
constexpr int kStyleCorrections = 3;      // of the weights at an example's parameters
constexpr double kMinOfStyle = 0.2;       // less is left out
constexpr double kFarFromExamples = 0.4;  // metres
constexpr double kMeanOver = 0.06;        // standard deviation, of the parameters' ranges
constexpr double kMinOfMean = 0.05;       // examples that count less are left out

constexpr std::array kMatched = {Role::hips,
                                 Role::chest,
                                 Role::head,
                                 Role::left_upper_arm,
                                 Role::left_lower_arm,
                                 Role::left_hand,
                                 Role::right_upper_arm,
                                 Role::right_lower_arm,
                                 Role::right_hand,
                                 Role::left_upper_leg,
                                 Role::left_lower_leg,
                                 Role::left_foot,
                                 Role::right_upper_leg,
                                 Role::right_lower_leg,
                                 Role::right_foot};

// Joints at one end of a step, in the frame of the print that the foot strikes there: places, and
// velocities times kVelocityTime. Joints that the skeleton lacks are at the origin.
using Ends = Eigen::Matrix<float, 6 * static_cast<int>(kMatched.size()), 1>;

Vec3 place_at(const Clip& clip, int joint, double time) {
  const double frame =
      std::clamp(time * clip.rate, 0.0, static_cast<double>(clip.frame_count() - 1));
  const int before = std::min(static_cast<int>(frame), std::max(0, clip.frame_count() - 2));
  const int after = std::min(before + 1, clip.frame_count() - 1);
  const auto part = static_cast<float>(frame - before);
  return ((1 - part) * clip.frame_positions(before)[at(joint)] +
          part * clip.frame_positions(after)[at(joint)])
      .cast<double>();
}

// `inwards`: +1 at the begin of the step, -1 at its end.
Ends ends_of(const Clip& clip, const RoleMap& roles, const parametric::FootShape& foot, double time,
             double inwards) {
  const Transform to_print = parametric::print_at(foot, clip, time).to_world().inverse();
  Ends ends = Ends::Zero();
  for (std::size_t k = 0; k < kMatched.size(); ++k) {
    const int joint = roles.joint(kMatched[k]);
    if (joint < 0) continue;
    const Vec3 here = to_print * place_at(clip, joint, time);
    const Vec3 there = to_print * place_at(clip, joint, time + inwards * kVelocityOver);
    const auto row = static_cast<Eigen::Index>(6 * k);
    ends.segment<3>(row) = here.cast<float>();
    ends.segment<3>(row + 3) =
        (inwards * kVelocityTime / kVelocityOver * (there - here)).cast<float>();
  }
  return ends;
}

// 0 to 1 by the seed, the step and the example (splitmix64, Steele and others 2014).
double chance(std::uint64_t seed, std::size_t step, std::size_t example) {
  std::uint64_t value = seed * 0x9e3779b97f4a7c15u + step * 0xbf58476d1ce4e5b9u + example + 1;
  for (int i = 0; i < 2; ++i) {
    value += 0x9e3779b97f4a7c15u;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    value ^= value >> 31;
  }
  return static_cast<double>(value >> 11) * 0x1p-53;
}

// The example of the step before.
struct Before {
  const Ends* ends = nullptr;  // null: there is none
  std::string capture;
};

// The steps of one library with one swing foot.
class Examples {
 public:
  Examples(const StepLibrary& steps, FootSide swing)
      : all_(&steps), swing_(swing), steps_(&steps.steps(swing)) {
    const parametric::Library& library = steps_->library();
    const parametric::Bounds& bounds = steps_->bounds();
    std::vector<double> scaled(library.parameters.size());
    for (std::size_t i = 0; i < library.examples.size(); ++i) {
      const parametric::Example& example = library.examples[i];
      const auto& times = example.keytimes;
      // Of standing there is no footprint but the stance foot's.
      const bool strikes = library.keytimes.back() == "swing_strike";
      begins_.push_back(
          ends_of(example.motion, steps.roles(), library.foot(library.stance()), times.front(), 1));
      finishes_.push_back(ends_of(example.motion, steps.roles(),
                                  library.foot(strikes ? library.swing : library.stance()),
                                  times.back(), -1));
      captures_.emplace_back(parametric::capture_of(example.name));
      bounds.scale(example.parameters, scaled);
      scaled_.insert(scaled_.end(), scaled.begin(), scaled.end());
    }
  }

  const parametric::Synthesiser& steps() const { return *steps_; }
  Before before(int example) const { return {&finishes_[at(example)], captures_[at(example)]}; }

  // The example for a step with these parameters after one that ended like `before`, if there is
  // one. `last`: examples of the last steps of this kind.
  int choose(std::span<const double> parameters, const Before& before, std::span<const int> last,
             std::uint64_t seed, std::size_t step) const {
    std::vector<double> scaled(parameters.size());
    steps_->bounds().scale(parameters, scaled);
    double least = std::numeric_limits<double>::infinity();
    int best = -1;
    for (std::size_t i = 0; i < begins_.size(); ++i) {
      if (!all_->in_style(i)) continue;
      double cost = kOfParameters * far_from(i, scaled) + kByChance * chance(seed, step, i);
      if (steps_->library().examples[i].mirrored) cost += kOtherFoot;
      for (std::size_t k = 0; k < last.size(); ++k) {
        if (last[k] != static_cast<int>(i)) continue;
        cost += kAgain * static_cast<double>(k + 1 + kLastSteps - last.size()) / kLastSteps;
      }
      if (cost >= least) continue;
      if (before.ends != nullptr) {
        if (captures_[i] != before.capture) cost += kOtherCapture;
        cost += std::sqrt((begins_[i] - *before.ends).squaredNorm() /
                          static_cast<float>(kMatched.size()));
      }
      if (cost >= least) continue;
      least = cost;
      best = static_cast<int>(i);
    }
    return best;
  }

  // What the examples of the style differ by from the blends at their own parameters: the mean of
  // those near these parameters, [examples].
  std::vector<double> mean_style(std::span<const double> parameters,
                                 const std::vector<std::uint8_t>& is_asked) {
    std::vector<double> scaled(parameters.size()), mean(begins_.size(), 0);
    steps_->bounds().scale(parameters, scaled);
    double sum = 0;
    for (std::size_t i = 0; i < begins_.size(); ++i) {
      const double counts = std::exp(-0.5 * far_from(i, scaled) / (kMeanOver * kMeanOver));
      if (!all_->in_style(i) || counts < kMinOfMean) continue;
      const std::vector<double>& fit = fitted(static_cast<int>(i), is_asked);
      if (fit.empty()) continue;
      sum += counts;
      mean[i] += counts;
      for (std::size_t k = 0; k < fit.size(); ++k) mean[k] -= counts * fit[k];
    }
    for (double& weight : mean) weight /= std::max(sum, kMinOfMean);
    return mean;
  }

  // The weights at an example's own parameters, and where none are asked for at the usual ones, so
  // that steps last longer or shorter as examples do; empty if there is no such blend, or if it is
  // the example.
  const std::vector<double>& fitted(int example, const std::vector<std::uint8_t>& is_asked) {
    auto& found = fitted_[{example, is_asked}];
    if (!found) {
      found.emplace();
      std::vector<double> parameters = steps_->library().examples[at(example)].parameters;
      take_usual(*all_, swing_, is_asked, parameters);
      auto made = steps_->weights(parameters, {true, kStyleCorrections});
      if (made) {
        double off = 0;
        for (std::size_t i = 0; i < made->weights.size(); ++i) {
          off += std::abs(made->weights[i] - (at(example) == i ? 1 : 0));
        }
        if (off > kNoStyle) *found = std::move(made->weights);
      }
    }
    return *found;
  }

 private:
  // Square of the distance from an example's parameters, of their ranges.
  double far_from(std::size_t example, std::span<const double> scaled) const {
    double far = 0;
    for (std::size_t d = 0; d < scaled.size(); ++d) {
      far += std::pow(scaled_[example * scaled.size() + d] - scaled[d], 2);
    }
    return far;
  }

  const StepLibrary* all_;
  FootSide swing_;
  const parametric::Synthesiser* steps_;
  std::vector<Ends> begins_, finishes_;  // [examples]
  std::vector<std::string> captures_;    // [examples]
  std::vector<double> scaled_;           // [examples x parameters]
  std::map<std::pair<int, std::vector<std::uint8_t>>, std::optional<std::vector<double>>> fitted_;
};

// The step with these shares of what the example, if there is one, and the style's mean differ by.
// Less of it where it would be no motion.
void add_style(Examples& examples, int example, double share, double of_mean, PlannedStep& step) {
  std::vector<double> added(step.weights.size(), 0);
  if (example >= 0) {
    const std::vector<double>& fitted = examples.fitted(example, step.is_asked);
    if (fitted.empty()) return;
    for (std::size_t k = 0; k < added.size(); ++k) added[k] = -share * fitted[k];
    added[at(example)] += share;
  }
  if (of_mean > 0) {
    const std::vector<double> mean = examples.mean_style(step.made, step.is_asked);
    for (std::size_t k = 0; k < added.size(); ++k) added[k] += of_mean * mean[k];
  }
  for (double part = 1; part > kMinOfStyle; part *= 0.5) {
    std::vector<double> weights = step.weights;
    for (std::size_t k = 0; k < weights.size(); ++k) weights[k] += part * added[k];
    if (!examples.steps().motion(weights)) continue;
    auto scratch = examples.steps().measure().make_scratch();
    std::vector<double> made(step.made.size());
    if (!examples.steps().measure()(weights, made, {}, scratch)) continue;
    step.made = std::move(made);
    step.weights = std::move(weights);
    step.example = example;
    step.example_share = part * share;
    return;
  }
}

}  // namespace

void choose_styles(std::span<const StepLibrary> libraries, const WalkOptions& options,
                   PlannedWalk& plan) {
  std::map<std::pair<int, FootSide>, Examples> all;
  std::map<std::pair<int, FootSide>, std::vector<int>> last;
  Before before;
  const bool varies = options.variation > 0;
  for (std::size_t i = 0; i < plan.steps.size(); ++i) {
    PlannedStep& step = plan.steps[i];
    const StepLibrary& library = libraries[at(step.library)];
    if (!varies && !library.has_style()) continue;
    const FootSide swing = plan.grounded[at(step.stance) + 1].side;
    const std::pair key{step.library, swing};
    auto place = all.find(key);
    if (place == all.end()) place = all.emplace(key, Examples(library, swing)).first;
    Examples& examples = place->second;
    int example = -1;
    if (varies) {
      std::vector<int>& used = last[key];
      example = examples.choose(step.made, before, used, options.seed, i);
      if (example < 0) continue;
      used.push_back(example);
      if (used.size() > kLastSteps) used.erase(used.begin());
      before = examples.before(example);
    }
    // A step that no example is near is blended with standing.
    const double near = 1 - smoother_step(step.far / kFarFromExamples);
    if (!(near > 0)) continue;
    const double share = options.variation * near;
    add_style(examples, example, share, library.has_style() ? near - share : 0, step);
  }
}

}  // namespace krok::gait
