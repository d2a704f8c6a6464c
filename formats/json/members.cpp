#include "formats/json/members.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/quantity.h"
#include "core/text.h"

namespace krok::json {

Error Members::wrong(const Value& value, std::string message, std::string hint) const {
  return error_at(text_, value.offset, format_ + "-value", std::move(message), std::move(hint));
}

Error Members::structure(const Value& value, std::string message) const {
  return error_at(text_, value.offset, format_ + "-structure", std::move(message));
}

Status Members::only(const Value& object, std::string_view what,
                     std::initializer_list<std::string_view> keys) const {
  if (object.kind != Value::Kind::object) {
    return structure(object,
                     fmt::format("{} is {}, expected an object", what, kind_name(object.kind)));
  }
  for (const Value::Member& entry : object.members) {
    if (std::ranges::find(keys, entry.key) != keys.end()) continue;
    const std::vector<std::string> known(keys.begin(), keys.end());
    return error_at(text_, entry.key_offset, format_ + "-structure",
                    fmt::format("{} has an unknown key '{}'", what, shown(entry.key)),
                    nearest_hint(entry.key, known));
  }
  return {};
}

Result<const Value*> Members::get(const Value& object, std::string_view what, std::string_view key,
                                  Value::Kind kind) const {
  auto value = find(object, what, key, kind);
  if (value && *value == nullptr) {
    return structure(object, fmt::format("{} is missing \"{}\"", what, key));
  }
  return value;
}

Result<const Value*> Members::find(const Value& object, std::string_view what, std::string_view key,
                                   Value::Kind kind) const {
  const Value* value = object.find(key);
  if (value != nullptr && value->kind != kind) {
    return wrong(*value, fmt::format("\"{}\" of {} is {}, expected {}", key, what,
                                     kind_name(value->kind), kind_name(kind)));
  }
  return value;
}

Result<std::optional<std::size_t>> Members::choice(
    const Value& object, std::string_view what, std::string_view key,
    std::initializer_list<std::string_view> words) const {
  const auto value = find(object, what, key, Value::Kind::string);
  if (!value) return value.error();
  if (*value == nullptr) return std::optional<std::size_t>();
  const auto* const found = std::ranges::find(words, (*value)->text);
  if (found != words.end()) {
    return std::optional(static_cast<std::size_t>(found - words.begin()));
  }
  const auto* const last = words.end() - 1;
  return wrong(**value, fmt::format("\"{}\" of {} is '{}'", key, what, shown((*value)->text)),
               fmt::format("use {} or {}", fmt::join(words.begin(), last, ", "), *last));
}

Result<std::optional<double>> Members::quantity(const Value& object, std::string_view what,
                                                std::string_view key, Parser parse) const {
  const Value* value = object.find(key);
  if (value == nullptr) return std::optional<double>();
  if (value->kind != Value::Kind::number && value->kind != Value::Kind::string) {
    return wrong(*value,
                 fmt::format("\"{}\" of {} is {}, expected a number or a string with a unit", key,
                             what, kind_name(value->kind)));
  }
  const std::string text =
      value->kind == Value::Kind::number ? fmt::format("{}", value->number) : value->text;
  const auto number = parse(text);
  if (!number) {
    return wrong(*value, fmt::format("\"{}\" of {}: {}", key, what, number.error().message),
                 number.error().hint);
  }
  return std::optional(*number);
}

Result<std::string> Members::path(const Value& value, std::string_view what) const {
  if (value.kind != Value::Kind::string) {
    return wrong(value, fmt::format("{} is {}, expected a file path", what, kind_name(value.kind)));
  }
  const std::string fault = path_fault(value.text);
  if (fault.empty()) return value.text;
  return error_at(text_, value.offset, format_ + "-path",
                  fmt::format("{}, '{}', {}", what, shown(value.text), fault),
                  "paths are relative to the file and must stay in its folder");
}

Result<double> Members::number(const Value& object, std::string_view what, std::string_view key,
                               double least, double most) const {
  const auto value = get(object, what, key, Value::Kind::number);
  if (!value) return value.error();
  return within(**value, fmt::format("\"{}\" of {}", key, what), least, most);
}

Result<double> Members::within(const Value& value, std::string_view name, double least,
                               double most) const {
  if (value.kind != Value::Kind::number) {
    return wrong(value, fmt::format("{} is {}, expected a number", name, kind_name(value.kind)));
  }
  if (value.number >= least && value.number <= most) return value.number;
  return wrong(value, fmt::format("{} is {}, expected {} to {}", name, readable(value.number),
                                  readable(least), readable(most)));
}

Result<double> Members::moment(const Value& value, std::string_view name,
                               std::optional<double> rate, double latest) const {
  if (value.kind != Value::Kind::string) return within(value, name, 0, latest);
  const auto parsed = parse_clip_time(value.text);
  if (!parsed) {
    return wrong(value, fmt::format("{}: {}", name, parsed.error().message),
                 "write 1.5, \"1.5s\", \"250ms\" or \"120f\"");
  }
  if (parsed->in_frames && !rate) {
    return wrong(value, fmt::format("{} is in frames, but the file has no \"rate\"", name));
  }
  Value seconds = value;
  seconds.kind = Value::Kind::number;
  seconds.number = parsed->seconds(rate.value_or(1));
  return within(seconds, name, 0, latest);
}

Result<double> Members::moment(const Value& object, std::string_view what, std::string_view key,
                               std::optional<double> rate, double latest) const {
  const Value* const value = object.find(key);
  if (value == nullptr) return structure(object, fmt::format("{} is missing \"{}\"", what, key));
  return moment(*value, fmt::format("\"{}\" of {}", key, what), rate, latest);
}

Result<std::vector<double>> Members::numbers(const Value& list, std::string_view what,
                                             std::string_view key, std::size_t count) const {
  std::vector<double> found;
  for (const Value& item : list.items) {
    if (item.kind == Value::Kind::number && std::isfinite(item.number))
      found.push_back(item.number);
  }
  if (found.size() == count && list.items.size() == count) return found;
  return wrong(list, fmt::format("\"{}\" of {} must be {} numbers", key, what, count));
}

Status Members::has_schema(const Value& object, std::string_view what,
                           std::string_view schema) const {
  const auto found = get(object, what, "schema", Value::Kind::string);
  if (!found) return found.error();
  if ((*found)->text == schema) return {};
  return structure(**found,
                   fmt::format("the schema is '{}', expected {}", shown((*found)->text), schema));
}

}  // namespace krok::json
