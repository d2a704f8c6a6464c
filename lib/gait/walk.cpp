#include "gait/walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "gait/walk_maker_internal.h"

namespace krok::gait {

namespace {

constexpr double kMaxTransforms = 4e8;
constexpr double kMissed = 1e-4;  // metres that count as a footprint missed

Status check_options(std::span<const StepLibrary> libraries, const WalkOptions& options) {
  if (libraries.empty()) return Error("walk-library", "walking needs a step library");
  for (const StepLibrary& library : libraries.subspan(1)) {
    if (Status status =
            parametric::same_skeleton(libraries[0].library().skeleton, library.library().skeleton);
        !status) {
      return status;
    }
  }
  if (!(options.speed >= 0.1 && options.speed <= 10)) {
    return Error("walk-time", fmt::format("a speed of {} is out of range", readable(options.speed)),
                 "give 0.1 to 10 times the library's");
  }
  return {};
}

StepReport report_of(std::span<const StepLibrary> libraries, const PlannedWalk& plan,
                     std::size_t index, const BodyStep& step) {
  const PlannedStep& planned = plan.steps[index];
  StepReport report;
  report.stance = planned.stance;
  report.start = step.start;
  report.end = step.strike;
  report.library = libraries[static_cast<std::size_t>(planned.library)].name();
  report.asked = planned.asked;
  report.made = planned.made;
  const auto to = static_cast<std::size_t>(planned.stance) + 1;
  report.moved = plan.moved[to];
  report.why_moved = plan.why_moved[to];
  return report;
}

}  // namespace

Result<Walk> walk(std::span<const StepLibrary> libraries, std::span<const Print> prints,
                  const Terrain& ground, const WalkOptions& options, Progress* progress) {
  if (Status status = check_options(libraries, options); !status) return status.error();
  const auto walker = make_walker(libraries[0]);
  if (!walker) return walker.error();
  auto plan = plan_steps(libraries, *walker, prints, ground, options);
  if (!plan) return plan.error();
  auto body = BodyMotion::create(libraries, *walker, *plan, options);
  if (!body) return body.error();
  const double rate = options.rate > 0 ? options.rate : libraries[0].library().rate;
  const double values =
      body->steps().back().finish * rate * static_cast<double>(walker->skeleton->names.size());
  if (!(values <= kMaxTransforms)) {
    return Error("clip-too-long",
                 fmt::format("{} s at {} frames per second are too many frames",
                             readable(body->steps().back().finish), readable(rate)));
  }
  Walk result;
  result.prints = plan->grounded;
  for (std::size_t i = 0; i < plan->steps.size(); ++i) {
    result.steps.push_back(report_of(libraries, *plan, i, body->steps()[i]));
  }
  WalkMaker(*walker, *plan, *body, ground, options, rate).make(result, progress);
  const auto& packed = libraries[0].steps(FootSide::left).packed();
  if (packed.hips_root.changes()) {
    result.clip = packed.hips_root.restored(result.clip, libraries[0].library().skeleton);
  }
  result.warnings = std::move(plan->warnings);
  for (const StepReport& step : result.steps) {
    if (step.missed <= kMissed) continue;
    Diagnostic warning;
    warning.severity = Severity::warning;
    warning.code = "walk-missed";
    warning.message = fmt::format("print {}: a leg is {} mm too short for its footprint",
                                  step.stance + 1, readable(1000 * step.missed, 3));
    warning.hint = "move the prints closer together, or allow --stretch";
    result.warnings.push_back(std::move(warning));
  }
  return result;
}

}  // namespace krok::gait
