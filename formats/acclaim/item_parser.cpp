#include "formats/acclaim/files_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "core/numbers.h"
#include "core/text.h"
#include "math/quaternion.h"

namespace krok::acclaim {

namespace {

constexpr std::array<std::string_view, 7> kChannelNames = {"tx", "ty", "tz", "rx", "ry", "rz", "l"};

std::optional<Channel> parse_channel(std::string_view word) {
  for (std::size_t i = 0; i < kChannelNames.size(); ++i) {
    if (same_word(word, kChannelNames[i])) return static_cast<Channel>(i);
  }
  return std::nullopt;
}

// "XYZ": three different axes, in the order of application.
std::optional<EulerOrder> parse_order(std::string_view word) {
  EulerOrder order{};
  if (word.size() != order.size()) return std::nullopt;
  std::array<bool, 3> seen{};
  for (std::size_t i = 0; i < order.size(); ++i) {
    const int axis = ascii_lower(word[i]) - 'x';
    if (axis < 0 || axis > 2 || seen[static_cast<std::size_t>(axis)]) return std::nullopt;
    seen[static_cast<std::size_t>(axis)] = true;
    order[i] = static_cast<Axis>(axis);
  }
  return order;
}

}  // namespace

std::string_view channel_name(Channel channel) {
  return kChannelNames[static_cast<std::size_t>(channel)];
}

Quat PrintedAxes::rotation(double radians) const {
  Quat q = Quat::Identity();
  for (const Axis axis : order) {
    q = axis_rotation(axis, angles[static_cast<int>(axis)] * radians) * q;
  }
  return normalized_or_identity(q);
}

Result<double> ItemParser::number(const std::string& what) {
  const Token token = cursor_.next();
  const auto value = parse_finite(token.text);
  if (value) return *value;
  return source_.error(
      token.offset, "acclaim-number",
      token.end() ? fmt::format("the file ends in the {}", what)
                  : fmt::format("'{}' in the {} is not a finite number", shown(token.text), what),
      token.end() ? "the file is truncated; export or copy it again" : "");
}

Status ItemParser::vector(const std::string& what, Vec3& vector) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = number(what);
    if (!value) return value.error();
    vector[axis] = *value;
  }
  return {};
}

Status ItemParser::channels(std::vector<Channel>& channels, const std::string& whose) {
  for (Token token = cursor_.peek(); !token.end() && !token.starts_line; token = cursor_.peek()) {
    cursor_.next();
    const auto channel = parse_channel(token.text);
    if (!channel) {
      return source_.error(
          token.offset, "acclaim-dof",
          fmt::format("'{}' is not a degree of freedom (of {})", shown(token.text), whose),
          "use tx ty tz rx ry rz l");
    }
    if (std::find(channels.begin(), channels.end(), *channel) != channels.end()) {
      return source_.error(token.offset, "acclaim-dof",
                           fmt::format("{} has {} twice", whose, channel_name(*channel)));
    }
    channels.push_back(*channel);
  }
  return {};
}

Status ItemParser::axis_order(const std::string& whose, EulerOrder& order) {
  const Token token = cursor_.peek();
  if (token.end() || token.starts_line) {
    return source_.fault(token.offset, "acclaim-syntax",
                         fmt::format("the axis of {} has no order, assumed to be XYZ", whose));
  }
  cursor_.next();
  const auto parsed = parse_order(token.text);
  if (!parsed) {
    return source_.error(token.offset, "acclaim-syntax",
                         fmt::format("'{}' is not an axis order (of {})", shown(token.text), whose),
                         "write XYZ or another permutation");
  }
  order = *parsed;
  return {};
}

Status ItemParser::skip_unknown(const Token& token) {
  cursor_.skip_line();
  return source_.fault(token.offset, "acclaim-keyword",
                       fmt::format("'{}' is unknown, the line is ignored", shown(token.text)));
}

}  // namespace krok::acclaim
