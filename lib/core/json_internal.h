#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

// For sources only, not for public headers. Parsing and writing are compiled once, in json.cpp, for
// both kinds of JSON object: members sorted by name, or in insertion order.

namespace krok {

// Parses `text`; the result is_discarded() if it is not JSON.
nlohmann::json parse_json(std::string_view text);
nlohmann::ordered_json parse_ordered_json(std::string_view text);
// Same, but throws nlohmann::json::parse_error.
nlohmann::json parse_json_or_throw(std::string_view text);

// `value` as text, on one line or indented by `indent` spaces. Invalid UTF-8 becomes U+FFFD.
std::string json_text(const nlohmann::json& value, int indent = -1);
std::string json_text(const nlohmann::ordered_json& value, int indent = -1);

// JSON text with what printable() replaces (core/text.h) as escape sequences, so that its strings
// are the same. JSON has these characters in strings alone, and none below U+0020.
std::string with_escaped_controls(const std::string& json);

}  // namespace krok
