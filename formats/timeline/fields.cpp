#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/timeline/fields_internal.h"
#include "math/types.h"

namespace krok::timeline_file {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::size_t kLongestName = 200;
constexpr std::size_t kMaxEntries = 10'000;
constexpr double kMax = 1e9;  // of any number

}  // namespace

Status Fields::only(const Value& object, std::string_view what,
                    std::initializer_list<std::string_view> keys) const {
  return in_.only(object, what, keys);
}

Error Fields::wrong(const Field& field, const std::string& expected,
                    const std::string& hint) const {
  std::string found(json::kind_name(field.value->kind));
  if (field.value->kind == Kind::number) found = readable(field.value->number);
  if (field.value->kind == Kind::string) found = fmt::format("'{}'", shown(field.value->text));
  return in_.wrong(
      *field.value,
      fmt::format("\"{}\" of {} is {}, expected {}", field.key, field.what, found, expected), hint);
}

template <typename T, typename Parse, typename Make>
Result<T> Fields::quantity(const Field& field, const Parse& parse, const Make& make) const {
  if (field.value->kind == Kind::number) {
    if (std::isfinite(field.value->number) && std::abs(field.value->number) <= kMax) {
      return make(field.value->number);
    }
    return wrong(field, "a number within +-1e9");
  }
  if (field.value->kind != Kind::string) return wrong(field, "a number, or a string with a unit");
  const auto parsed = parse(field.value->text);
  if (!parsed) {
    return wrong(
        field, "a number with a unit",
        parsed.error().message + (parsed.error().hint.empty() ? "" : "; " + parsed.error().hint));
  }
  return *parsed;
}

Result<ClipTime> Fields::time(const Field& field) const {
  auto found = quantity<ClipTime>(field, parse_clip_time, [](double seconds) {
    return ClipTime{seconds, false};
  });
  if (found && !(std::abs(found->value) <= kMax)) return wrong(field, "a time within +-1e9");
  return found;
}

Result<double> Fields::length(const Field& field) const {
  auto found = quantity<double>(field, parse_length, [](double metres) { return metres; });
  if (found && !(std::abs(*found) <= 1e6)) return wrong(field, "at most 1000 km");
  return found;
}

Result<double> Fields::angle(const Field& field) const {
  auto found = quantity<double>(field, parse_angle,
                                [](double degrees) { return degrees * kRadiansPerDegree; });
  if (found && !(std::abs(*found) <= 1e6)) return wrong(field, "an angle within +-1e6 rad");
  return found;
}

Result<double> Fields::number(const Field& field) const {
  if (field.value->kind != Kind::number || !(std::abs(field.value->number) <= kMax)) {
    return wrong(field, "a number");
  }
  return field.value->number;
}

Result<int> Fields::whole(const Field& field, int low, int high) const {
  const double value = field.value->number;
  if (field.value->kind != Kind::number || value != std::floor(value) || value < low ||
      value > high) {
    return wrong(field, fmt::format("an integer from {} to {}", low, high));
  }
  return static_cast<int>(value);
}

Result<bool> Fields::truth(const Field& field) const {
  if (field.value->kind != Kind::boolean) return wrong(field, "true or false");
  return field.value->truth;
}

Result<double> Fields::duration(const Field& field, double rate) const {
  const auto found = time(field);
  if (!found) return found.error();
  if (found->in_frames && rate == 0) {
    return wrong(field, "seconds", "durations in frames need a \"rate\" in the file");
  }
  if (!(found->value >= 0)) return wrong(field, "0 s or more");
  return found->seconds(rate);
}

Result<const Value*> Fields::entries(const Value& object, std::string_view what,
                                     std::string_view key) const {
  auto list = in_.find(object, what, key, Kind::array);
  if (list && *list != nullptr && (*list)->items.size() > kMaxEntries) {
    return in_.wrong(**list, fmt::format("\"{}\" has {} entries, at most {} are allowed", key,
                                         (*list)->items.size(), kMaxEntries));
  }
  return list;
}

Result<std::string> Fields::name(const Field& field) const {
  const std::string& text = field.value->text;
  const bool plain = std::ranges::none_of(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
  if (field.value->kind != Kind::string || text.empty() || !plain || text.size() > kLongestName) {
    return wrong(field, fmt::format("a name of 1 to {} bytes", kLongestName));
  }
  return text;
}

Result<std::size_t> Fields::word_index(const Field& field,
                                       const std::vector<std::string>& words) const {
  if (field.value->kind == Kind::string) {
    const auto found = std::ranges::find(words, field.value->text);
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    return wrong(field, "a known value", nearest_hint(field.value->text, words));
  }
  return wrong(field, "a known value", fmt::format("use one of {}", fmt::join(words, ", ")));
}

}  // namespace krok::timeline_file
