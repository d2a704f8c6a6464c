#include "capture/convention_choice.h"

#include <fmt/format.h>

#include "core/numbers.h"

namespace krok {

namespace {

constexpr const char* kGiven = "as given";

bool parallel(Direction a, Direction b) {
  return direction_vector(a).dot(direction_vector(b)) != 0.0;
}

std::string how(bool given, Confidence confidence) {
  return given ? "given" : fmt::format("detected, {}", confidence_name(confidence));
}

}  // namespace

void apply_given(const GivenConventions& given, Conventions& conventions) {
  const std::string axes_reason = given.axes_reason.empty() ? kGiven : given.axes_reason;
  if (given.unit) {
    conventions.unit = *given.unit;
    conventions.unit_confidence = Confidence::certain;
    conventions.unit_reason = kGiven;
  }
  if (given.up) {
    if (given.axes_given(given.up) && conventions.up != *given.up &&
        conventions.up_confidence != Confidence::guess) {
      conventions.up_doubt =
          fmt::format("{} is {}: {}", direction_name(conventions.up),
                      confidence_name(conventions.up_confidence), conventions.up_reason);
    }
    conventions.up = conventions.reference_up = *given.up;
    conventions.up_confidence = given.axes_confidence;
    conventions.up_reason = axes_reason;
  }
  if (given.forward) {
    // With another up axis, what is ahead was looked for along the wrong ones.
    if (given.axes_given(given.forward) && conventions.forward != *given.forward &&
        conventions.forward_confidence != Confidence::guess && conventions.up_doubt.empty()) {
      conventions.forward_doubt =
          fmt::format("{} is {}: {}", direction_name(conventions.forward),
                      confidence_name(conventions.forward_confidence), conventions.forward_reason);
    }
    conventions.forward = conventions.reference_forward = *given.forward;
    conventions.forward_confidence = given.forward_confidence;
    conventions.forward_reason = axes_reason;
  }
  if (given.reference_up) conventions.reference_up = *given.reference_up;
  if (given.reference_forward) conventions.reference_forward = *given.reference_forward;
  if (given.up && given.forward) return;
  if (!parallel(conventions.up, conventions.forward) &&
      !parallel(conventions.reference_up, conventions.reference_forward)) {
    return;
  }
  if (given.up) {
    const bool along_z = parallel(*given.up, Direction::plus_z);
    conventions.forward = along_z ? Direction::minus_y : Direction::plus_z;
    conventions.reference_forward = conventions.forward;
    conventions.forward_confidence = Confidence::guess;
    conventions.forward_reason = "the detected axis is parallel to the given up axis";
  } else if (given.forward) {
    const bool along_y = parallel(*given.forward, Direction::plus_y);
    conventions.up = along_y ? Direction::plus_z : Direction::plus_y;
    conventions.reference_up = conventions.up;
    conventions.up_confidence = Confidence::guess;
    conventions.up_reason = "the detected axis is parallel to the given forward axis";
  }
}

Result<Conversion> Conversion::make(const Conventions& conventions) {
  auto turn = rotation_to_krok(conventions.up, conventions.forward);
  if (!turn) return std::move(turn).error();
  auto reference = rotation_to_krok(conventions.reference_up, conventions.reference_forward);
  if (!reference) return std::move(reference).error();
  Conversion conversion;
  conversion.metres_ = conventions.unit.metres;
  conversion.turn_ = *turn;
  conversion.reference_turn_ = *reference;
  conversion.to_krok_ = turn->toRotationMatrix().array().round().matrix();
  conversion.reference_to_krok_ = reference->toRotationMatrix().array().round().matrix();
  if (conversion.to_krok_ != conversion.reference_to_krok_) {
    conversion.reference_to_motion_.orientation = *turn * reference->conjugate();
  }
  return conversion;
}

Transform Conversion::pose(const Transform& joint_to_world) const {
  return {to_krok_ * (joint_to_world.position * metres_),
          turn_ * joint_to_world.orientation * reference_turn_.conjugate()};
}

Transform Conversion::reference(const Transform& joint_to_world) const {
  return {reference_to_krok_ * (joint_to_world.position * metres_),
          reference_rotation(joint_to_world.orientation)};
}

Quat Conversion::reference_rotation(const Quat& rotation) const {
  return reference_turn_ * rotation * reference_turn_.conjugate();
}

void report_conventions(const Conventions& conventions, const GivenConventions& given,
                        const std::string& code_prefix, const std::string& file_name,
                        Diagnostics& diagnostics) {
  const auto report = [&](bool is_given, const char* name, const char* subject,
                          const std::string& value, Confidence confidence,
                          const std::string& reason) {
    if (is_given) return;
    const bool guess = confidence == Confidence::guess;
    Diagnostic diagnostic;
    diagnostic.severity = guess ? Severity::warning : Severity::note;
    diagnostic.code = fmt::format("{}-{}", code_prefix, name);
    diagnostic.message = fmt::format("{} is {} ({})", subject, value, confidence_name(confidence)) +
                         (reason.empty() ? std::string() : ": " + reason);
    if (guess) diagnostic.hint = fmt::format("set it with --{} if that is wrong", name);
    if (guess && name == std::string_view("up") && code_prefix != "scene") {
      diagnostic.hint += ", or take the axes of a take that stands with --axes-from";
    }
    diagnostic.where.file = file_name;
    diagnostics.push_back(std::move(diagnostic));
  };
  report(given.unit.has_value(), "unit", "the unit", conventions.unit.name,
         conventions.unit_confidence, conventions.unit_reason);
  const auto doubt = [&](const char* name, Direction is, const std::string& why) {
    if (why.empty()) return;
    diagnostics.push_back(
        make_warning(fmt::format("{}-{}", code_prefix, name),
                     fmt::format("{} is {}, as given; {}", name, direction_name(is), why),
                     fmt::format("without --{} it is detected", name), file_name));
  };
  doubt("up", conventions.up, conventions.up_doubt);
  doubt("forward", conventions.forward, conventions.forward_doubt);
  report(given.axes_given(given.up), "up", "up", std::string(direction_name(conventions.up)),
         conventions.up_confidence, conventions.up_reason);
  report(given.axes_given(given.forward), "forward", "forward",
         std::string(direction_name(conventions.forward)), conventions.forward_confidence,
         conventions.forward_reason);
}

std::vector<std::string> describe_conversions(const Conventions& conventions,
                                              const GivenConventions& given) {
  std::vector<std::string> lines;
  if (conventions.unit.metres != 1.0) {
    lines.push_back(fmt::format("unit: {} ({} m) to metres ({})", conventions.unit.name,
                                readable(conventions.unit.metres),
                                how(given.unit.has_value(), conventions.unit_confidence)));
  }
  const auto axes = [&](const char* what, Direction up, Direction forward) {
    if (up == Direction::plus_y && forward == Direction::plus_z) return;
    lines.push_back(fmt::format(
        "{}: up {} ({}), forward {} ({}) to up y, forward z", what, direction_name(up),
        how(given.axes_given(given.up), conventions.up_confidence), direction_name(forward),
        how(given.axes_given(given.forward), conventions.forward_confidence)));
  };
  axes("axes", conventions.up, conventions.forward);
  if (conventions.reference_up != conventions.up ||
      conventions.reference_forward != conventions.forward) {
    axes("axes of the reference pose", conventions.reference_up, conventions.reference_forward);
  }
  return lines;
}

}  // namespace krok
