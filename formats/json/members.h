#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "formats/json/located_json.h"

namespace krok::json {

// Reads members of objects and checks them against the format. Errors name the object ("a
// contact"), the key of the member, and line and column.
class Members {
 public:
  // Errors have the codes FORMAT-structure (missing or unknown member, not an object) and
  // FORMAT-value. `text` is the argument of parse() and must outlive this.
  Members(std::string_view text, std::string format) : text_(text), format_(std::move(format)) {}

  // An error about a value: FORMAT-value, at its location.
  Error wrong(const Value& value, std::string message, std::string hint = {}) const;

  // An error about the members of an object: FORMAT-structure, at its location.
  Error structure(const Value& value, std::string message) const;

  // Checks that `object` is an object without any other keys.
  Status only(const Value& object, std::string_view what,
              std::initializer_list<std::string_view> keys) const;

  // A required member of that kind.
  Result<const Value*> get(const Value& object, std::string_view what, std::string_view key,
                           Value::Kind kind) const;

  // An optional member of that kind; nullptr if missing.
  Result<const Value*> find(const Value& object, std::string_view what, std::string_view key,
                            Value::Kind kind) const;

  // An optional string that must be one of `words`: its index.
  Result<std::optional<std::size_t>> choice(const Value& object, std::string_view what,
                                            std::string_view key,
                                            std::initializer_list<std::string_view> words) const;

  // An optional quantity: a number in the default unit of `parse`, or a string with a unit, such as
  // "1.5cm" with parse_length().
  using Parser = Result<double> (*)(std::string_view);
  Result<std::optional<double>> quantity(const Value& object, std::string_view what,
                                         std::string_view key, Parser parse) const;

  // A string that path_fault() of core/path_inside.h accepts; otherwise an Error (FORMAT-path).
  // `what` names the path in the message.
  Result<std::string> path(const Value& value, std::string_view what) const;

  // A required number from `least` to `most`.
  Result<double> number(const Value& object, std::string_view what, std::string_view key,
                        double least, double most) const;

  // The same for a value; `name` is for messages.
  Result<double> within(const Value& value, std::string_view name, double least, double most) const;

  // A list of `count` finite numbers, the value of `key` of the object `what`.
  Result<std::vector<double>> numbers(const Value& list, std::string_view what,
                                      std::string_view key, std::size_t count) const;

  // A time in seconds from 0 to `latest`: a number, or a string such as "250ms", or "120f" if there
  // is a frame rate.
  Result<double> moment(const Value& value, std::string_view name, std::optional<double> rate,
                        double latest) const;
  // The same for a required member.
  Result<double> moment(const Value& object, std::string_view what, std::string_view key,
                        std::optional<double> rate, double latest) const;

  // Checks that the required member "schema" is `schema`.
  Status has_schema(const Value& object, std::string_view what, std::string_view schema) const;

 private:
  std::string_view text_;
  std::string format_;
};

}  // namespace krok::json
