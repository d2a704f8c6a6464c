#include "parametric/parameter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/text.h"
#include "math/transform.h"

namespace krok::parametric {

namespace {

constexpr std::array<std::string_view, 7> kQuantities = {
    "step.length", "step.width", "step.height", "step.turn", "duration", "", "step.path_turn"};
constexpr std::array<std::string_view, 3> kDirections = {"across", "up", "along"};

Error wrong(std::string message, std::string hint) {
  return {"parametric-parameter", std::move(message), std::move(hint)};
}

template <typename Names>
std::optional<int> index_of(const Names& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<int>(found - names.begin());
}

bool is_step(Quantity quantity) {
  return quantity <= Quantity::step_turn || quantity == Quantity::path_turn;
}

// Parses "LeftHand.up".
Status parse_joint(std::string_view name, const Skeleton& skeleton, Parameter& parameter) {
  const auto dot = name.rfind('.');
  const auto axis =
      dot == std::string_view::npos ? std::nullopt : index_of(kDirections, name.substr(dot + 1));
  if (!axis) {
    return wrong(
        fmt::format("unknown parameter {}", shown(name)),
        "use step.length, step.width, step.height, step.turn, step.path_turn, duration, or "
        "a joint "
        "with .across, .up or .along, @ and a keytime");
  }
  parameter.quantity = Quantity::joint;
  parameter.direction = static_cast<Direction>(*axis);
  parameter.joint = skeleton.find(name.substr(0, dot));
  if (parameter.joint >= 0) return {};
  return wrong(fmt::format("the skeleton has no joint {}", shown(name.substr(0, dot))),
               "krok-info --json lists the joints");
}

}  // namespace

std::string_view unit_of(const Parameter& parameter) {
  if (is_turn(parameter.quantity)) return "rad";
  return parameter.quantity == Quantity::duration ? "s" : "m";
}

double usual_tolerance(Quantity quantity) {
  return is_turn(quantity) ? 0.1 * kRadiansPerDegree : 1e-3;
}

std::string name_of(const Parameter& parameter, const Skeleton& skeleton,
                    std::span<const std::string> keytimes) {
  const auto keytime = static_cast<std::size_t>(parameter.keytime);
  std::string name;
  if (parameter.quantity == Quantity::joint) {
    name = fmt::format("{}.{}", skeleton.names[static_cast<std::size_t>(parameter.joint)],
                       kDirections[static_cast<std::size_t>(parameter.direction)]);
  } else {
    name = kQuantities[static_cast<std::size_t>(parameter.quantity)];
    if (!is_step(parameter.quantity) || keytime + 1 == keytimes.size()) return name;
  }
  return name + "@" + keytimes[keytime];
}

Result<Parameter> parse_parameter(std::string_view name, const Skeleton& skeleton,
                                  std::span<const std::string> keytimes) {
  Parameter parameter;
  const auto at = name.rfind('@');
  const std::string_view what = name.substr(0, at);
  if (const auto quantity = index_of(kQuantities, what); quantity && !what.empty()) {
    parameter.quantity = static_cast<Quantity>(*quantity);
  } else if (Status status = parse_joint(what, skeleton, parameter); !status) {
    return status.error();
  }
  parameter.tolerance = usual_tolerance(parameter.quantity);
  parameter.keytime = static_cast<int>(keytimes.size()) - 1;
  const bool has_keytime = at != std::string_view::npos;
  if (!has_keytime && parameter.quantity != Quantity::joint) return parameter;
  const auto keytime = has_keytime ? index_of(keytimes, name.substr(at + 1)) : std::nullopt;
  if (!keytime || parameter.quantity == Quantity::duration) {
    return wrong(fmt::format("{} has no valid keytime", shown(name)),
                 fmt::format("keytimes are {}", fmt::join(keytimes, ", ")));
  }
  parameter.keytime = *keytime;
  return parameter;
}

Status check(std::span<const Parameter> parameters, const Skeleton& skeleton,
             std::span<const std::string> keytimes) {
  if (parameters.empty()) return wrong("no parameters", "name at least one");
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& one = parameters[i];
    const bool known = one.quantity <= Quantity::path_turn && one.direction <= Direction::along;
    const bool joint =
        one.quantity != Quantity::joint || (one.joint >= 0 && one.joint < skeleton.joint_count());
    const bool keytime = one.keytime >= 0 && one.keytime < static_cast<int>(keytimes.size());
    if (!known || !joint || !keytime || !(one.tolerance > 0) || !std::isfinite(one.tolerance)) {
      return wrong(fmt::format("parameter {} is invalid", i + 1),
                   "its joint, keytime or tolerance is out of range");
    }
    for (std::size_t j = 0; j < i; ++j) {
      const std::string name = name_of(one, skeleton, keytimes);
      if (name != name_of(parameters[j], skeleton, keytimes)) continue;
      return wrong(fmt::format("duplicate parameter {}", name), "remove one of them");
    }
  }
  return {};
}

}  // namespace krok::parametric
