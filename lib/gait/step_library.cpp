#include "gait/step_library.h"

#include <algorithm>
#include <cmath>

#include "gait/mean_step_internal.h"
#include "motion/ground_frame.h"

namespace krok::gait {

namespace {

constexpr double kShortWay = 0.1;  // metres: of steps on the spot

// The angle between the stance foot, when flat, and the hips' way over the mean step.
double mean_toe_out(const parametric::Synthesiser& steps) {
  const parametric::PackedExamples& packed = steps.packed();
  const parametric::Library& library = steps.library();
  const Vec3 way = position_of(mean_pose(packed, packed.generic.back()), 0) -
                   position_of(mean_pose(packed, 0), 0);
  const PoseVector flat = mean_pose(packed, middle_of_swing(packed, library));
  const parametric::FootShape& foot = library.foot(library.stance());
  const Vec3 toes = joint_to_world(packed.skeleton, flat, foot.joint).orientation * foot.forward;
  if (std::hypot(way.x(), way.z()) < kShortWay) return 0;
  const double angle = std::atan2(toes.x(), toes.z()) - std::atan2(way.x(), way.z());
  return (library.stance() == FootSide::left ? 1 : -1) * wrapped(angle);
}

}  // namespace

Result<StepLibrary> StepLibrary::create(std::string name, parametric::Library library,
                                        const rbf::WeightFunction& weights, const RoleMap& roles) {
  using parametric::Quantity;
  const auto measures = [&](Quantity quantity) {
    return std::ranges::any_of(library.parameters, [&](const parametric::Parameter& parameter) {
      return parameter.quantity == quantity;
    });
  };
  const std::vector<std::string>& times = library.keytimes;
  if (!measures(Quantity::step_length) || times.front() != "stance_strike" ||
      times.back() != "swing_strike" || std::ranges::find(times, "swing_off") == times.end()) {
    return Error("walk-library",
                 "this is no library of steps: walking needs the parameter step.length and the "
                 "keytimes stance_strike, swing_off and swing_strike",
                 "krok-fit makes one with \"steps\": \"auto\"");
  }
  StepLibrary result;
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
  result.toe_out_ = mean_toe_out(result.steps(result.own_));
  return result;
}

}  // namespace krok::gait
