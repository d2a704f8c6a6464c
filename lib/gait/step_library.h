#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "parametric/synthesise.h"
#include "rbf/weight_function.h"
#include "roles/roles.h"

// A fitted library of steps, prepared for walking with both feet.

namespace krok::gait {

// Which steps a library has, by its keytimes: the middle of a walk or of a run, the first step out
// of standing, the last one into it, or standing itself. In a run the stance foot leaves the ground
// before the swing foot strikes.
enum class StepKind : unsigned char { walk, run, start, stop, stand };

// The swing foot's print at the end of a step in the frame of the stance foot's: metres along the
// stance foot's toes, to the swing side, up; radians to that side.
struct FoundStep {
  double along = 0, across = 0, up = 0, turn = 0;
};

class StepLibrary {
 public:
  // A library of walks or runs has step.length among its parameters; steps of the other foot are
  // the mirror image of those given. `name` is for reports. Codes: those of Synthesiser::create()
  // and mirrored(); walk-library if the library has no step.length, keytimes that are not those of
  // steps, or starts or stops forward and backward.
  static Result<StepLibrary> create(std::string name, parametric::Library library,
                                    const rbf::WeightFunction& weights, const RoleMap& roles);

  const std::string& name() const { return name_; }
  StepKind kind() const { return kind_; }
  // Neither out of standing nor into it.
  bool is_middle() const { return kind_ == StepKind::walk || kind_ == StepKind::run; }
  const RoleMap& roles() const { return roles_; }
  // As fitted, with the swing foot of its examples.
  const parametric::Library& library() const { return *libraries_[static_cast<std::size_t>(own_)]; }
  // Radians by which feet usually point outwards from the way they go.
  double toe_out() const { return toe_out_; }

  // Limits the steps' style, durations, usual lengths and toe-out to the examples of a style, or of
  // captures whose names contain it, in any case. Returns whether there are any; otherwise all
  // examples count, as before the call.
  bool take_style(std::string_view style);
  bool has_style() const { return !in_style_.empty(); }
  bool in_style(std::size_t example) const { return in_style_.empty() || in_style_[example] != 0; }

  // The examples' steps, whether or not all of it is a parameter. [examples]
  const std::vector<FoundStep>& found_steps() const { return found_steps_; }

  // Steps whose swing foot is `swing`.
  const parametric::Synthesiser& steps(FootSide swing) const {
    return *synthesisers_[static_cast<std::size_t>(swing)];
  }

 private:
  StepLibrary() = default;

  std::string name_;
  StepKind kind_ = StepKind::walk;
  std::vector<FoundStep> found_steps_;
  std::vector<std::uint8_t> in_style_;  // [examples], empty: all
  RoleMap roles_;
  FootSide own_ = FootSide::left;
  double toe_out_ = 0;
  std::array<std::unique_ptr<const parametric::Library>, 2> libraries_;  // [swing side]
  std::array<std::unique_ptr<const parametric::Synthesiser>, 2> synthesisers_;
};

// Limits all libraries to a style, see StepLibrary::take_style(); those of starts and stops may
// lack it. Code walk-style if none of walks or runs has it.
Status take_style(std::span<StepLibrary> libraries, std::string_view style);

// The first library of walks, which has the skeleton, the rate and the feet; without walks the
// first of runs; the first if there is none.
const StepLibrary& main_library(std::span<const StepLibrary> libraries);

}  // namespace krok::gait
