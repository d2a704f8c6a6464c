#pragma once

#include <cassert>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

// Errors and warnings as values. The library never prints and never exits: a function that can fail
// returns Result<T> and reports recoverable problems as a list of Diagnostics.

namespace krok {

enum class Severity { note, warning, error };

// A location in a file. Lines and columns count from 1 (columns in bytes), 0 is unknown;
// byte_offset counts from 0, -1 is unknown. Text formats give lines, binary formats byte offsets.
struct Location {
  std::string file;
  std::int64_t line = 0;
  std::int64_t column = 0;
  std::int64_t byte_offset = -1;
};

// A message for the user. `code` is short and stable, such as "bvh-channel-count"; `message` says
// what is wrong and why, in lower case without a full stop; `hint` says what to do, and may be
// empty.
struct Diagnostic {
  Severity severity = Severity::error;
  std::string code;
  std::string message;
  std::string hint;
  Location where;
  std::string joint;        // the joint concerned, if any
  std::int64_t frame = -1;  // the frame concerned, from 0; -1 for none
};

using Diagnostics = std::vector<Diagnostic>;

inline Diagnostic make_diagnostic(Severity severity, std::string code, std::string message,
                                  std::string hint = {}, std::string file = {}) {
  return {severity, std::move(code), std::move(message), std::move(hint), {std::move(file)}, {}};
}
inline Diagnostic make_warning(std::string code, std::string message, std::string hint = {},
                               std::string file = {}) {
  return make_diagnostic(Severity::warning, std::move(code), std::move(message), std::move(hint),
                         std::move(file));
}

// A Diagnostic that made an operation fail.
struct Error : Diagnostic {
  Error() = default;
  Error(std::string error_code, std::string text, std::string what_to_do = {}) {
    code = std::move(error_code);
    message = std::move(text);
    hint = std::move(what_to_do);
  }
  explicit Error(Diagnostic diagnostic) : Diagnostic(std::move(diagnostic)) {}

  // Sets the location; a file that is already set is kept.
  [[nodiscard]] Error in_file(const std::string& path) && {
    if (where.file.empty()) where.file = path;
    return std::move(*this);
  }
  [[nodiscard]] Error at_line(std::int64_t line, std::int64_t column = 0) && {
    where.line = line;
    where.column = column;
    return std::move(*this);
  }
  [[nodiscard]] Error at_byte(std::int64_t offset) && {
    where.byte_offset = offset;
    return std::move(*this);
  }
};

// A value or an Error. Accessing the value of a failed result is a programming error (assert).
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & { return assert(ok()), *std::get_if<0>(&state_); }
  const T& value() const& { return assert(ok()), *std::get_if<0>(&state_); }
  T&& value() && { return assert(ok()), std::move(*std::get_if<0>(&state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  Error& error() & { return assert(!ok()), *std::get_if<1>(&state_); }
  const Error& error() const& { return assert(!ok()), *std::get_if<1>(&state_); }
  Error&& error() && { return assert(!ok()), std::move(*std::get_if<1>(&state_)); }

 private:
  std::variant<T, Error> state_;
};

// Success or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : failed_(true), error_(std::move(error)) {}  // NOLINT: implicit

  bool ok() const { return !failed_; }
  explicit operator bool() const { return ok(); }
  Error& error() & { return assert(failed_), error_; }
  const Error& error() const& { return assert(failed_), error_; }
  Error&& error() && { return assert(failed_), std::move(error_); }

 private:
  bool failed_ = false;
  Error error_;
};

using Status = Result<void>;

}  // namespace krok
