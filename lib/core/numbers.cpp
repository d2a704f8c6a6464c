#include "core/numbers.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <span>

namespace krok {

namespace {

// from_chars does not accept '+', which people and some exporters write.
std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  return text;
}

}  // namespace

std::optional<double> parse_finite(std::string_view text) {
  text = without_plus(text);
  double value = 0;
  const char* end = text.data() + text.size();
  const auto parsed = fast_float::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<long long> parse_integer(std::string_view text) {
  text = without_plus(text);
  long long value = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
  return value;
}

std::string shortest(double value) {
  return fmt::format("{}", value == 0 ? 0.0 : value);
}
std::string shortest(float value) {
  return fmt::format("{}", value == 0 ? 0.0f : value);
}

std::string readable(double value, int digits) {
  if (value == 0) return "0";
  if (!std::isfinite(value)) return fmt::format("{}", value);
  const double magnitude = std::abs(value);
  if (magnitude < 1e-4 || magnitude >= 1e9) return fmt::format("{:.{}g}", value, digits);
  const int before = static_cast<int>(std::floor(std::log10(magnitude))) + 1;
  const int decimals = digits > before ? digits - before : 0;
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find('.') != std::string::npos) {
    while (text.back() == '0') text.pop_back();
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string grouped(long long value) {
  std::string text = fmt::format("{}", value);
  const std::size_t sign = value < 0 ? 1 : 0;
  for (std::size_t i = text.size(); i > sign + 3; i -= 3) text.insert(i - 3, ",");
  return text;
}

std::string counted(long long count, std::string_view one, std::string_view many) {
  if (count == 1) return fmt::format("1 {}", one);
  return many.empty() ? fmt::format("{} {}s", grouped(count), one)
                      : fmt::format("{} {}", grouped(count), many);
}

namespace {

struct NamedUnit {
  std::string_view name;
  double size;
};

struct Split {
  double number;
  std::string_view unit;
};

// What to write instead: "1.5s" for 00:00:01.5.
std::string hint_for(std::string_view text) {
  if (text.ends_with('%'))
    return "write the quantity itself with its unit, as 0.1mm: what it would be a share of is not "
           "known";
  double seconds = 0;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    const auto part = parse_finite(text.substr(begin, end - begin));
    if (!part || (begin == 0 && end == text.size())) return "enter a number with an optional unit";
    seconds = 60 * seconds + *part;
    begin = end + 1;
  }
  return fmt::format("times are in seconds: write {}s", readable(seconds, 9));
}

// The unit is the letters (or degree sign) at the end; the rest is the number.
Result<Split> split(std::string_view text) {
  std::size_t end = text.size();
  while (end > 0 && ((text[end - 1] >= 'a' && text[end - 1] <= 'z') ||
                     (text[end - 1] >= 'A' && text[end - 1] <= 'Z') ||
                     static_cast<unsigned char>(text[end - 1]) >= 0x80)) {
    --end;
  }
  std::string_view number = text.substr(0, end);
  while (!number.empty() && number.back() == ' ') number.remove_suffix(1);
  const auto value = parse_finite(number);
  if (!value) {
    return Error("quantity-number", fmt::format("'{}' is not a number", text), hint_for(text));
  }
  return Split{*value, text.substr(end)};
}

Result<double> parse_with(std::string_view text, std::span<const NamedUnit> units, double bare) {
  const auto parts = split(text);
  if (!parts) return parts.error();
  if (parts->unit.empty()) return parts->number * bare;
  std::string known;
  for (const NamedUnit& unit : units) {
    if (unit.name == parts->unit) return parts->number * unit.size;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", unit.name);
  }
  return Error("quantity-unit", fmt::format("invalid unit '{}' in '{}'", parts->unit, text),
               fmt::format("use one of {}", known));
}

Error without_unit(std::string_view text, std::string_view usual) {
  return {"quantity-no-unit", fmt::format("'{}' has no unit", text),
          usual == "m" ? fmt::format("write {}m", text)
                       : fmt::format("write {}{}, or {}m if metres are meant", text, usual, text)};
}

constexpr std::array kLengths = {
    NamedUnit{"m", 1.0},   NamedUnit{"dm", 0.1},    NamedUnit{"cm", 0.01},  NamedUnit{"mm", 0.001},
    NamedUnit{"um", 1e-6}, NamedUnit{"in", 0.0254}, NamedUnit{"ft", 0.3048}};
constexpr std::array kAngles = {NamedUnit{"deg", std::numbers::pi / 180.0}, NamedUnit{"rad", 1.0},
                                NamedUnit{"\u00B0", std::numbers::pi / 180.0}};
constexpr std::array kFrequencies = {NamedUnit{"Hz", 1.0}};
constexpr std::array kTimes = {NamedUnit{"s", 1.0}, NamedUnit{"ms", 0.001}, NamedUnit{"f", 1.0}};

}  // namespace

Result<double> parse_length(std::string_view text) {
  constexpr double kMaxBare = 50;  // metres
  const auto bare = parse_finite(text);
  if (bare && std::abs(*bare) >= kMaxBare) return without_unit(text, "cm");
  return parse_with(text, kLengths, 1.0);
}

Result<double> parse_length_with_unit(std::string_view text, std::string_view usual) {
  const auto bare = parse_finite(text);
  if (bare && *bare != 0) return without_unit(text, usual);
  return parse_length(text);
}

Result<double> parse_angle(std::string_view text) {
  return parse_with(text, kAngles, std::numbers::pi / 180.0);
}

Result<double> parse_frequency(std::string_view text) {
  return parse_with(text, kFrequencies, 1.0);
}

Result<ClipTime> parse_clip_time(std::string_view text) {
  const auto value = parse_with(text, kTimes, 1.0);
  if (!value) return value.error();
  return ClipTime{*value, text.ends_with('f')};
}

}  // namespace krok
