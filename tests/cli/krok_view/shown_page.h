#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace krok::test {

// The text of an element of a page that krok-view wrote.
inline std::string element_of(const std::string& page, const std::string& id) {
  const std::string start = "id=\"" + id + "\">";
  const auto at = page.find(start);
  if (at == std::string::npos) return {};
  const auto begin = at + start.size();
  return page.substr(begin, page.find("</script>", begin) - begin);
}

// The description that the page carries of what it shows.
inline nlohmann::json data_of(const std::string& page) {
  return nlohmann::json::parse(element_of(page, "krok-data"));
}

// What base64 text holds.
inline std::string bytes_of_base64(const std::string& text) {
  static const std::string kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0, count = 0;
  for (const char c : text) {
    const auto digit = kDigits.find(c);
    if (digit == std::string::npos) break;  // padding
    bits = bits << 6 | static_cast<unsigned>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xFF);
  }
  return bytes;
}

}  // namespace krok::test
