#pragma once

#include <array>
#include <memory>
#include <string>

#include "core/result.h"
#include "parametric/synthesise.h"
#include "rbf/weight_function.h"
#include "roles/roles.h"

// A fitted library of steps, prepared for walking with both feet.

namespace krok::gait {

class StepLibrary {
 public:
  // `library` has step.length among its parameters; steps of the other foot are its mirror image.
  // `name` is for reports. Codes: those of Synthesiser::create() and mirrored(); walk-library if
  // the library has no step.length, or keytimes that are not those of steps.
  static Result<StepLibrary> create(std::string name, parametric::Library library,
                                    const rbf::WeightFunction& weights, const RoleMap& roles);

  const std::string& name() const { return name_; }
  const RoleMap& roles() const { return roles_; }
  // As fitted, with the swing foot of its examples.
  const parametric::Library& library() const { return *libraries_[static_cast<std::size_t>(own_)]; }
  // Radians by which feet usually point outwards from the way they go.
  double toe_out() const { return toe_out_; }

  // Steps whose swing foot is `swing`.
  const parametric::Synthesiser& steps(FootSide swing) const {
    return *synthesisers_[static_cast<std::size_t>(swing)];
  }

 private:
  StepLibrary() = default;

  std::string name_;
  RoleMap roles_;
  FootSide own_ = FootSide::left;
  double toe_out_ = 0;
  std::array<std::unique_ptr<const parametric::Library>, 2> libraries_;  // [swing side]
  std::array<std::unique_ptr<const parametric::Synthesiser>, 2> synthesisers_;
};

}  // namespace krok::gait
