#include "formats/bvh/names.h"

#include <fmt/format.h>

#include "formats/bvh/text_cursor.h"

namespace krok::bvh {

namespace {

// More than these would drown what else there is to say.
constexpr int kMostWarnings = 20;

}  // namespace

std::string UniqueNames::make(const std::string& name) {
  if (claim(name)) return name;
  int& number = numbers_.try_emplace(name, 1).first->second;
  for (;;) {
    std::string candidate = fmt::format("{}_{}", name, ++number);
    if (claim(candidate)) return candidate;
  }
}

void make_names_unique(std::vector<NamedPlace>& places, std::string_view text,
                       const std::string& file_name, Diagnostics& diagnostics) {
  Locator locate(text, file_name);
  int duplicates = 0;
  int recoded = 0;
  const auto warn = [&](const NamedPlace& place, const char* code, std::string message) {
    Diagnostic warning;
    warning.severity = Severity::warning;
    warning.code = code;
    warning.message = std::move(message);
    warning.where = locate(place.offset);
    warning.joint = *place.name;
    diagnostics.push_back(std::move(warning));
  };

  UniqueNames names;
  std::vector<std::size_t> renamed;
  // Names that the file gives come first, so that a made-up one never takes a given one's place.
  for (std::size_t i = 0; i < places.size(); ++i) {
    NamedPlace& place = places[i];
    if (place.end_site) continue;
    if (!is_utf8(*place.name)) {
      *place.name = latin1_to_utf8(*place.name);
      if (++recoded <= kMostWarnings) {
        warn(place, "bvh-name",
             fmt::format("the name of joint {} is not UTF-8 and was read as Latin-1", *place.name));
      }
    }
    if (place.name->empty() || !names.claim(*place.name)) renamed.push_back(i);
  }
  for (const std::size_t i : renamed) {
    NamedPlace& place = places[i];
    const std::string given = *place.name;
    *place.name = names.make(given.empty() ? "joint" : given);
    if (!given.empty() && ++duplicates <= kMostWarnings) {
      warn(place, "bvh-name-duplicate",
           fmt::format("another joint is named {} already; this one is called {}", given,
                       *place.name));
    }
  }
  if (duplicates > kMostWarnings) {
    Diagnostic more;
    more.severity = Severity::warning;
    more.code = "bvh-name-duplicate";
    more.message =
        fmt::format("{} more joints with a name that was given before", duplicates - kMostWarnings);
    more.where.file = file_name;
    diagnostics.push_back(std::move(more));
  }
  for (NamedPlace& place : places) {
    if (!place.end_site) continue;
    *place.name = names.make(*places[static_cast<std::size_t>(place.parent)].name + "_end");
  }
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    const std::size_t length = c < 0x80                ? 1
                               : c >= 0xC2 && c < 0xE0 ? 2
                               : c >= 0xE0 && c < 0xF0 ? 3
                               : c >= 0xF0 && c < 0xF5 ? 4
                                                       : 0;
    if (length == 0 || i + length > text.size()) return false;
    for (std::size_t k = 1; k < length; ++k) {
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return false;
    }
    if (length > 2) {
      // Overlong forms, surrogates and code points beyond the last.
      const auto second = static_cast<unsigned char>(text[i + 1]);
      if ((c == 0xE0 && second < 0xA0) || (c == 0xED && second > 0x9F) ||
          (c == 0xF0 && second < 0x90) || (c == 0xF4 && second > 0x8F)) {
        return false;
      }
    }
    i += length;
  }
  return true;
}

std::string latin1_to_utf8(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      result += c;
    } else {
      result += static_cast<char>(0xC0 | (byte >> 6));
      result += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return result;
}

std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 40;
  const bool cut = text.size() > kMost;
  const std::string_view part = text.substr(0, kMost);
  std::string result;
  for (const char c : is_utf8(part) ? std::string(part) : latin1_to_utf8(part)) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte < 0x20 || byte == 0x7F ? '?' : c;
  }
  return cut ? result + "..." : result;
}

std::string readable_name(std::string_view name) {
  return name.empty() ? "a joint without a name" : shown(name);
}

}  // namespace krok::bvh
