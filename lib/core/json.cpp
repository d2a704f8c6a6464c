#include "core/json_internal.h"

#include <fmt/format.h>

#include "core/text.h"

namespace krok {

nlohmann::json parse_json(std::string_view text) {
  return nlohmann::json::parse(text, nullptr, false);
}

nlohmann::ordered_json parse_ordered_json(std::string_view text) {
  return nlohmann::ordered_json::parse(text, nullptr, false);
}

nlohmann::json parse_json_or_throw(std::string_view text) {
  return nlohmann::json::parse(text);
}

std::string with_escaped_controls(const std::string& text) {
  const std::string safe = printable(text, true);
  if (safe == text) return text;
  std::string result;
  std::size_t i = 0;
  for (const char c : safe) {
    if (c == text[i]) {
      result += c;
      ++i;
      continue;
    }
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[i + k]); };
    const unsigned code = byte(0) == 0xC2 ? byte(1)
                          : byte(0) == 0x7F
                              ? 0x7F
                              : 0x2000U + ((byte(1) & 0x3FU) << 6) + (byte(2) & 0x3FU);
    result += fmt::format("\\u{:04x}", code);
    i += byte(0) == 0xC2 ? 2 : byte(0) == 0x7F ? 1 : 3;
  }
  return result;
}

std::string json_text(const nlohmann::json& value, int indent) {
  return with_escaped_controls(
      value.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string json_text(const nlohmann::ordered_json& value, int indent) {
  return with_escaped_controls(
      value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace krok
