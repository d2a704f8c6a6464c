#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

// Height images assembled by hand, so that reader tests depend on no image library. Sources:
// OpenEXR File Layout; ISO/IEC 15948 (PNG), RFC 1950 and 1951 (stored blocks).

namespace krok::test {

inline void put_little(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * i) & 0xFF);
}
inline void put_big(std::string& out, std::uint64_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out += static_cast<char>(value >> (8 * i) & 0xFF);
}

struct ExrChannel {
  std::string name;
  std::vector<float> values;  // row by row
};

// An uncompressed OpenEXR image of 32-bit floats; channels must be in alphabetical order. The
// header says `said_columns` and `said_rows` if those are given.
inline std::string exr_image(int columns, int rows, const std::vector<ExrChannel>& channels,
                             int said_columns = 0, int said_rows = 0) {
  const auto bits = [](float value) {
    std::uint32_t number = 0;
    std::memcpy(&number, &value, 4);
    return number;
  };
  std::string out;
  put_little(out, 20000630, 4);
  put_little(out, 2, 4);
  const auto attribute = [&](const std::string& name, const std::string& type,
                             const std::string& value) {
    out += name + '\0' + type + '\0';
    put_little(out, value.size(), 4);
    out += value;
  };
  std::string list;
  for (const ExrChannel& channel : channels) {
    list += channel.name + '\0';
    for (const std::uint32_t number : {2, 0, 1, 1}) put_little(list, number, 4);
  }
  list += '\0';
  std::string window;
  put_little(window, 0, 8);
  put_little(window, static_cast<std::uint32_t>((said_columns != 0 ? said_columns : columns) - 1),
             4);
  put_little(window, static_cast<std::uint32_t>((said_rows != 0 ? said_rows : rows) - 1), 4);
  std::string one, centre(8, '\0');
  put_little(one, bits(1), 4);
  attribute("channels", "chlist", list);
  attribute("compression", "compression", std::string(1, '\0'));
  attribute("dataWindow", "box2i", window);
  attribute("displayWindow", "box2i", window);
  attribute("lineOrder", "lineOrder", std::string(1, '\0'));
  attribute("pixelAspectRatio", "float", one);
  attribute("screenWindowCenter", "v2f", centre);
  attribute("screenWindowWidth", "float", one);
  out += '\0';
  const std::size_t line = 4 * channels.size() * static_cast<std::size_t>(columns);
  const std::size_t first = out.size() + 8 * static_cast<std::size_t>(rows);
  for (int row = 0; row < rows; ++row) {
    put_little(out, first + static_cast<std::size_t>(row) * (line + 8), 8);
  }
  for (int row = 0; row < rows; ++row) {
    put_little(out, static_cast<std::uint32_t>(row), 4);
    put_little(out, line, 4);
    for (const ExrChannel& channel : channels) {
      for (int column = 0; column < columns; ++column) {
        put_little(out, bits(channel.values[static_cast<std::size_t>(row * columns + column)]), 4);
      }
    }
  }
  return out;
}

// A PNG of `kind` 0 (grey), 2 (colour) or 4 (grey and alpha), 16 bits or 8; `values` has all
// channels, row by row. The header says other sizes if those are given.
inline std::string png_image(int columns, int rows, int kind,
                             const std::vector<std::uint16_t>& values, int said_columns = 0,
                             int said_rows = 0, int bits = 16) {
  const auto crc = [](const std::string& text) {
    std::uint32_t sum = 0xFFFFFFFF;
    for (const char c : text) {
      sum ^= static_cast<unsigned char>(c);
      for (int bit = 0; bit < 8; ++bit) sum = (sum & 1) != 0 ? sum >> 1 ^ 0xEDB88320 : sum >> 1;
    }
    return ~sum;
  };
  std::string out = "\x89PNG\r\n\x1A\n";
  const auto chunk = [&](const std::string& name, const std::string& content) {
    put_big(out, content.size(), 4);
    out += name + content;
    put_big(out, crc(name + content), 4);
  };
  std::string header;
  put_big(header, static_cast<std::uint32_t>(said_columns != 0 ? said_columns : columns), 4);
  put_big(header, static_cast<std::uint32_t>(said_rows != 0 ? said_rows : rows), 4);
  header += {static_cast<char>(bits), static_cast<char>(kind), 0, 0, 0};
  const std::size_t per_row = values.size() / static_cast<std::size_t>(rows);
  std::string raw;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % per_row == 0) raw += '\0';  // no filter
    put_big(raw, values[i], bits / 8);
  }
  std::uint32_t a = 1, b = 0;
  for (const char c : raw) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  std::string packed = "\x78\x01\x01";  // one stored block
  put_little(packed, raw.size(), 2);
  put_little(packed, ~raw.size(), 2);
  packed += raw;
  put_big(packed, b << 16 | a, 4);
  chunk("IHDR", header);
  chunk("IDAT", packed);
  chunk("IEND", "");
  return out;
}

}  // namespace krok::test
