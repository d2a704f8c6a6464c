#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// JSON parser for small, hand-written files. Keeps the location of each value, so that errors can
// be reported with line and column.

namespace krok::json {

struct Value {
  enum class Kind : unsigned char { null, boolean, number, string, array, object };
  struct Member;

  Kind kind = Kind::null;
  std::size_t offset = 0;  // of its first byte in the text
  bool truth = false;      // boolean
  double number = 0;
  std::string text;             // string, UTF-8
  std::vector<Value> items;     // array
  std::vector<Member> members;  // object, in the file's order, keys unique

  // The member's value, or nullptr.
  const Value* find(std::string_view key) const;
};

struct Value::Member {
  std::string key;
  std::size_t key_offset = 0;
  Value value;
};

// "a number", for messages.
std::string_view kind_name(Value::Kind kind);

// Parses one JSON value (RFC 8259) with nothing after it; a byte-order mark is skipped. Limits: 32
// levels of nesting, 1000 keys per object, `largest` bytes; a duplicate key is an error. Codes
// json-syntax, json-limit, with line and column.
Result<Value> parse(std::string_view text, std::size_t largest = std::size_t{16} << 20);

// An error about the value that begins at `offset` of `text`, with its line and column.
Error error_at(std::string_view text, std::size_t offset, std::string code, std::string message,
               std::string hint = {});

// A quoted JSON string; bytes that are not UTF-8 become U+FFFD.
std::string in_quotes(std::string_view text);

}  // namespace krok::json
