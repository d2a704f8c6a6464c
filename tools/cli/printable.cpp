#include "tools/cli/printable.h"

namespace krok::cli {

std::string printable(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // U+0080 to U+009F, in UTF-8 0xC2 and that byte, are control characters too.
    const bool two_bytes =
        byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    if (two_bytes) ++i;
    result += byte < 32 || byte == 127 || two_bytes ? '?' : text[i];
  }
  return result;
}

}  // namespace krok::cli
