#include "core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

namespace krok {

namespace {

// Length of the character that starts with a lead byte, and its bits; 0 for a byte that starts
// none.
struct Lead {
  std::size_t length = 0;
  std::uint32_t bits = 0;
  std::uint32_t least = 0;  // smaller values are overlong
};

Lead lead_of(unsigned char byte) {
  if (byte < 0x80) return {1, byte, 0};
  if (byte >= 0xC2 && byte < 0xE0) return {2, byte & 0x1Fu, 0x80};
  if (byte >= 0xE0 && byte < 0xF0) return {3, byte & 0x0Fu, 0x800};
  if (byte >= 0xF0 && byte < 0xF5) return {4, byte & 0x07u, 0x10000};
  return {};
}

bool is_code_point(std::uint32_t code) {
  return code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
}

// The character at `i`, which moves on behind it; empty where none is well-formed.
std::optional<char32_t> next_character(std::string_view text, std::size_t& i) {
  const Lead lead = lead_of(static_cast<unsigned char>(text[i]));
  if (lead.length == 0 || lead.length > text.size() - i) return std::nullopt;
  std::uint32_t character = lead.bits;
  for (std::size_t k = 1; k < lead.length; ++k) {
    const auto byte = static_cast<unsigned char>(text[i + k]);
    if ((byte & 0xC0) != 0x80) return std::nullopt;
    character = (character << 6) | (byte & 0x3Fu);
  }
  if (character < lead.least || !is_code_point(character)) return std::nullopt;
  i += lead.length;
  return character;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return text;
}

std::string ascii_lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = ascii_lower(c);
  return lower;
}

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return ascii_lower(x) == ascii_lower(y); });
}

Location Locator::operator()(std::size_t offset) {
  offset = std::min(offset, text_.size());
  if (offset < at_) {
    at_ = 0;
    line_begin_ = 0;
    line_ = 1;
  }
  for (; at_ < offset; ++at_) {
    if (!is_line_end(text_[at_])) continue;
    // A CR LF counts at its LF, which may be after `offset`.
    if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') continue;
    ++line_;
    line_begin_ = at_ + 1;
  }
  Location where;
  where.file = file_name_;
  where.line = line_;
  where.column = static_cast<std::int64_t>(offset - line_begin_) + 1;
  return where;
}

Location locate(std::string_view text, std::size_t offset, const std::string& file_name) {
  return Locator(text, file_name)(offset);
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    if (!next_character(text, i)) return false;
  }
  return true;
}

std::u32string code_points(std::string_view text) {
  std::u32string result;
  for (std::size_t i = 0; i < text.size();) {
    const auto character = next_character(text, i);
    result += character.value_or(kReplacementCharacter);
    if (!character) ++i;
  }
  return result;
}

void append_utf8(char32_t character, std::string& text) {
  const std::uint32_t code = is_code_point(character) ? character : kReplacementCharacter;
  const auto add = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) return add(code);
  if (code < 0x800) {
    add(0xC0 | code >> 6);
  } else if (code < 0x10000) {
    add(0xE0 | code >> 12);
    add(0x80 | (code >> 6 & 0x3F));
  } else {
    add(0xF0 | code >> 18);
    add(0x80 | (code >> 12 & 0x3F));
    add(0x80 | (code >> 6 & 0x3F));
  }
  add(0x80 | (code & 0x3F));
}

bool is_name(std::string_view text) {
  return !text.empty() && text.size() <= kLongestName &&
         text.find('\0') == std::string_view::npos && is_utf8(text);
}

std::string to_utf8(std::string_view text) {
  if (is_utf8(text)) return std::string(text);
  std::string utf8;
  for (const char c : text) append_utf8(static_cast<unsigned char>(c), utf8);
  return utf8;
}

std::string printable(std::string_view text, bool lines) {
  std::string result;
  result.reserve(text.size());
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool line = lines && (text[i] == '\n' || text[i] == '\t');
    // U+202A to U+202E and U+2066 to U+2069.
    const bool turns =
        byte(i) == 0xE2 && ((byte(i + 1) == 0x80 && byte(i + 2) >= 0xAA && byte(i + 2) <= 0xAE) ||
                            (byte(i + 1) == 0x81 && byte(i + 2) >= 0xA6 && byte(i + 2) <= 0xA9));
    const bool two_bytes = byte(i) == 0xC2 && byte(i + 1) >= 0x80 && byte(i + 1) < 0xA0;
    result += (byte(i) < 0x20 && !line) || byte(i) == 0x7F || two_bytes || turns ? '?' : text[i];
    i += turns ? 2 : two_bytes ? 1 : 0;
  }
  return result;
}

std::string shown(std::string_view text) {
  constexpr std::size_t kMax = 40;
  std::size_t length = std::min(text.size(), kMax);
  // Do not cut within a character.
  while (length < text.size() && length > kMax - 4 &&
         (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) {
    --length;
  }
  const std::string result = printable(to_utf8(text.substr(0, length)));
  return length < text.size() ? result + "..." : result;
}

std::string to_base64(std::span<const std::byte> bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  char* out = text.data();
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t here = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < here; ++k) {
      group |= std::to_integer<std::uint32_t>(bytes[i + k]) << (16 - 8 * k);
    }
    for (std::size_t k = 0; k <= here; ++k) out[k] = kDigits[group >> (18 - 6 * k) & 63U];
    out += 4;
  }
  return text;
}

std::string to_markup(std::string_view text) {
  // U+FFFE and U+FFFF are the only characters above the control characters that XML does not allow.
  const auto is_no_character = [](std::string_view rest) {
    return rest.substr(0, 3) == "\xEF\xBF\xBE" || rest.substr(0, 3) == "\xEF\xBF\xBF";
  };
  const std::string safe = printable(to_utf8(text), true);
  std::string result;
  for (std::size_t i = 0; i < safe.size(); ++i) {
    const char c = safe[i];
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (is_no_character(std::string_view(safe).substr(i))) {
          result += '?';
          i += 2;
        } else {
          result += c;
        }
    }
  }
  return result;
}

namespace {

constexpr std::size_t kMaxLetters = 64;

// Levenshtein distance, row by row, in which two letters in the wrong order are one mistake.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    row[0] = i + 1;
    for (std::size_t k = 0; k < b.size(); ++k) {
      row[k + 1] = std::min({last[k] + (a[i] == b[k] ? 0 : 1), last[k + 1] + 1, row[k] + 1});
      if (i > 0 && k > 0 && a[i] == b[k - 1] && a[i - 1] == b[k]) {
        row[k + 1] = std::min(row[k + 1], before[k - 1] + 1);
      }
    }
    before = last;
    last = row;
  }
  return last.back();
}

}  // namespace

std::string nearest_name(std::string_view word, std::span<const std::string> names) {
  const std::string wanted = ascii_lower(word.substr(0, kMaxLetters));
  const std::size_t dashes = wanted.starts_with("--") ? 2 : 0;
  std::string best;
  std::size_t least = 0;
  // One that has the whole word, or begins with it, is nearer than any with another letter: "hand"
  // is no head.
  constexpr std::size_t kWord = 4, kBeginning = 3;
  for (const std::string& name : names) {
    // "--max-influences" has more words than --influences.
    if (dashes > 0 && name.size() > dashes + kWord && wanted.ends_with(name.substr(1))) return name;
    const std::size_t found = ascii_lower(name).find(wanted);
    const std::size_t letters = found == 0 ? kBeginning : kWord;
    if (found == std::string::npos || wanted.size() < letters + dashes) continue;
    if (best.empty() || name.size() < best.size()) best = name;
  }
  if (!best.empty()) return best;
  // The same words in another order: "hand_left".
  const std::size_t under = wanted.rfind('_');
  for (const std::string& name : names) {
    if (under == std::string::npos || under == 0) break;
    if (name == wanted.substr(under + 1) + "_" + wanted.substr(0, under)) return name;
  }
  for (const std::string& name : names) {
    const std::string other = ascii_lower(std::string_view(name).substr(0, kMaxLetters));
    const std::size_t found = distance(wanted, other);
    const std::size_t longer = std::max(wanted.size(), other.size());
    // A third of the letters; of options, whose short words share many, without their dashes and
    // from the same first letter if more than one differs.
    const std::size_t near = std::max<std::size_t>(dashes > 0 ? 1 : 2, (longer - dashes) / 3);
    if (dashes > 0 && found > 1 && wanted[dashes] != other[dashes]) continue;
    const bool half = 2 * found + (found > 1 ? 1 : 0) > longer - dashes;
    if (found > near || half || (!best.empty() && found >= least)) continue;
    best = name;
    least = found;
  }
  return best;
}

std::string nearest_hint(std::string_view word, std::span<const std::string> names) {
  const std::string nearest = nearest_name(word, names);
  if (!nearest.empty()) return fmt::format("did you mean '{}'?", nearest);
  constexpr std::size_t kMaxNamed = 30;
  const std::size_t named = std::min(kMaxNamed, names.size());
  return fmt::format("expected one of {}{}", fmt::join(names.first(named), ", "),
                     named < names.size() ? fmt::format(" and {} more", names.size() - named) : "");
}

}  // namespace krok
