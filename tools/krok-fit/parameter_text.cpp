#include "tools/krok-fit/parameter_text.h"

namespace krok::cli::fit {

ShownUnit unit_for_values(const parametric::Parameter& parameter) {
  if (is_turn(parameter.quantity)) {
    return {"\u00B0", 1 / kRadiansPerDegree};
  }
  return {std::string(unit_of(parameter)), 1};
}

ShownUnit unit_for_errors(const parametric::Parameter& parameter) {
  switch (parameter.quantity) {
    case parametric::Quantity::step_turn:
    case parametric::Quantity::path_turn:
      return {"\u00B0", 1 / kRadiansPerDegree};
    case parametric::Quantity::duration:
      return {"ms", 1000};
    default:
      return {"mm", 1000};
  }
}

}  // namespace krok::cli::fit
