#include "gait/step_library.h"

#include <algorithm>

namespace krok::gait {

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
  auto mirrored = parametric::mirrored(library, roles);
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
  return result;
}

}  // namespace krok::gait
