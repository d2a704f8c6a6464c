#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"
#include "formats/json/located_json.h"

namespace krok::json {

// Takes members out of objects as a file's specification tells them. What is wrong is said with the
// words for the object ("a contact"), the member's key, and line and column.
class Members {
 public:
  // Errors get the codes FORMAT-structure (a member that is missing or not known, another kind of
  // object) and FORMAT-value. `text` is what parse() was given and must outlive this.
  Members(std::string_view text, std::string format) : text_(text), format_(std::move(format)) {}

  // An error about a value: FORMAT-value, at its place.
  Error wrong(const Value& value, std::string message, std::string hint = {}) const;

  // An error about what is in an object: FORMAT-structure, at its place.
  Error structure(const Value& value, std::string message) const;

  // Whether `object` is an object with none but these keys.
  Status only(const Value& object, std::string_view what,
              std::initializer_list<std::string_view> keys) const;

  // The member, which must be there and of that kind.
  Result<const Value*> get(const Value& object, std::string_view what, std::string_view key,
                           Value::Kind kind) const;

  // The same of a member that may be left out: nullptr then.
  Result<const Value*> find(const Value& object, std::string_view what, std::string_view key,
                            Value::Kind kind) const;

  // Which of `words` a text is that may be left out: its place among them.
  Result<std::optional<std::size_t>> choice(const Value& object, std::string_view what,
                                            std::string_view key,
                                            std::initializer_list<std::string_view> words) const;

  // A quantity that may be left out: a number in the unit that `parse` takes bare ones in, or a
  // text with a unit, such as "1.5cm" with parse_length().
  using Parser = Result<double> (*)(std::string_view);
  Result<std::optional<double>> quantity(const Value& object, std::string_view what,
                                         std::string_view key, Parser parse) const;

  // A text that path_fault() of core/path_inside.h finds nothing wrong with; otherwise an Error
  // (FORMAT-path). `what` is what the path is, for the message.
  Result<std::string> path(const Value& value, std::string_view what) const;

  // A number that must be there and lie within bounds.
  Result<double> number(const Value& object, std::string_view what, std::string_view key,
                        double least, double most) const;

  // The same of a number by itself; `name` is what messages call it.
  Result<double> within(const Value& value, std::string_view name, double least, double most) const;

  // A moment in seconds from 0 to `latest`: a number, or a text such as "250ms", or "120f" where
  // there is a rate to count frames at.
  Result<double> moment(const Value& value, std::string_view name, std::optional<double> rate,
                        double latest) const;
  // The same of a member that must be there.
  Result<double> moment(const Value& object, std::string_view what, std::string_view key,
                        std::optional<double> rate, double latest) const;

  // Whether the member "schema" is there and says `schema`.
  Status has_schema(const Value& object, std::string_view what, std::string_view schema) const;

 private:
  std::string_view text_;
  std::string format_;
};

}  // namespace krok::json
