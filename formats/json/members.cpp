#include "formats/json/members.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"

namespace krok::json {

Error Members::wrong(const Value& value, std::string message, std::string hint) const {
  return error_at(text_, value.offset, format_ + "-value", std::move(message), std::move(hint));
}

Status Members::only(const Value& object, std::string_view what,
                     std::initializer_list<std::string_view> keys) const {
  if (object.kind != Value::Kind::object) {
    return error_at(text_, object.offset, format_ + "-structure",
                    fmt::format("{} is {}, expected an object", what, kind_name(object.kind)));
  }
  for (const Value::Member& entry : object.members) {
    if (std::ranges::find(keys, entry.key) != keys.end()) continue;
    return error_at(text_, entry.key_offset, format_ + "-structure",
                    fmt::format("{} has no '{}'", what, shown(entry.key)),
                    fmt::format("known are {}", fmt::join(keys, ", ")));
  }
  return {};
}

Result<const Value*> Members::get(const Value& object, std::string_view what, std::string_view key,
                                  Value::Kind kind) const {
  auto value = find(object, what, key, kind);
  if (value && *value == nullptr) {
    return error_at(text_, object.offset, format_ + "-structure",
                    fmt::format("{} lacks \"{}\"", what, key));
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

Result<std::optional<double>> Members::quantity(const Value& object, std::string_view what,
                                                std::string_view key, Parser parse) const {
  const Value* value = object.find(key);
  if (value == nullptr) return std::optional<double>();
  if (value->kind != Value::Kind::number && value->kind != Value::Kind::string) {
    return wrong(*value, fmt::format("\"{}\" of {} is {}, expected a number or a text with a unit",
                                     key, what, kind_name(value->kind)));
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

Status Members::has_schema(const Value& object, std::string_view what,
                           std::string_view schema) const {
  const auto found = get(object, what, "schema", Value::Kind::string);
  if (!found) return found.error();
  if ((*found)->text == schema) return {};
  return error_at(text_, (*found)->offset, format_ + "-structure",
                  fmt::format("the schema is '{}', expected {}", shown((*found)->text), schema));
}

}  // namespace krok::json
