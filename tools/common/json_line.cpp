#include "tools/common/json_line.h"

#include <cstdint>

namespace krok {

namespace {

std::string by_library(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Whether JSON has the character as it is.
int is_plain(char c) {
  return static_cast<int>(c >= ' ') & static_cast<int>(c <= '~') & static_cast<int>(c != '"') &
         static_cast<int>(c != '\\');
}

void add_text(const std::string& text, std::string& line) {
  // Without a branch for each letter.
  int plain = 1;
  for (const char c : text) plain &= is_plain(c);
  if (plain == 0) {
    line += by_library(text);
    return;
  }
  line += '"';
  line += text;
  line += '"';
}

void add(const Json& value, std::string& line) {
  switch (value.type()) {
    case Json::value_t::object: {
      char before = '{';
      for (const auto& [name, member] : value.get_ref<const Json::object_t&>()) {
        line += before;
        add_text(name, line);
        line += ':';
        add(member, line);
        before = ',';
      }
      line += before == '{' ? "{}" : "}";
      return;
    }
    case Json::value_t::array: {
      char before = '[';
      for (const Json& element : value) {
        line += before;
        add(element, line);
        before = ',';
      }
      line += before == '[' ? "[]" : "]";
      return;
    }
    case Json::value_t::string:
      return add_text(value.get_ref<const std::string&>(), line);
    case Json::value_t::null:
      line += "null";
      return;
    case Json::value_t::boolean:
      line += value.get<bool>() ? "true" : "false";
      return;
    case Json::value_t::number_integer:
      line += std::to_string(value.get<std::int64_t>());
      return;
    case Json::value_t::number_unsigned:
      line += std::to_string(value.get<std::uint64_t>());
      return;
    default:
      line += by_library(value);
  }
}

}  // namespace

std::string json_line(const Json& value) {
  std::string line;
  add(value, line);
  return line;
}

}  // namespace krok
