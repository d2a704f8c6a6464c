#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

// For sources only, no public header. Parsing and writing are compiled once, in json.cpp, for the
// two kinds of JSON object: members by name, or in the order in which they were put in.
namespace krok {

// The value that `text` holds; it is_discarded() where `text` is not JSON.
nlohmann::json parse_json(std::string_view text);
nlohmann::ordered_json parse_ordered_json(std::string_view text);
// The same, but throws the library's parse_error.
nlohmann::json parse_json_or_throw(std::string_view text);

// `value` as text, on one line or indented by `indent` spaces. What is not UTF-8 becomes U+FFFD.
std::string json_text(const nlohmann::json& value, int indent = -1);
std::string json_text(const nlohmann::ordered_json& value, int indent = -1);

}  // namespace krok
