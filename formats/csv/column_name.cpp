#include <algorithm>
#include <array>

#include "core/text.h"
#include "formats/csv/table.h"

namespace krok::csv {

namespace {

struct UnitSuffix {
  std::string_view suffix;
  std::string_view unit;
};
// Longer ones first: "speed_m_s" is not "speed_m" in seconds.
constexpr std::array kSuffixes = {UnitSuffix{"_deg_per_s", "\u00B0/s"},
                                  UnitSuffix{"_rad_per_s", "rad/s"},
                                  UnitSuffix{"_m_per_s2", "m/s\u00B2"},
                                  UnitSuffix{"_m_per_s", "m/s"},
                                  UnitSuffix{"_deg_s", "\u00B0/s"},
                                  UnitSuffix{"_rad_s", "rad/s"},
                                  UnitSuffix{"_m_s2", "m/s\u00B2"},
                                  UnitSuffix{"_m_s", "m/s"},
                                  UnitSuffix{"_mm_s", "mm/s"},
                                  UnitSuffix{"_cm_s", "cm/s"},
                                  UnitSuffix{"_percent", "%"},
                                  UnitSuffix{"_deg", "\u00B0"},
                                  UnitSuffix{"_rad", "rad"},
                                  UnitSuffix{"_ms", "ms"},
                                  UnitSuffix{"_us", "\u00B5s"},
                                  UnitSuffix{"_mm", "mm"},
                                  UnitSuffix{"_cm", "cm"},
                                  UnitSuffix{"_km", "km"},
                                  UnitSuffix{"_kg", "kg"},
                                  UnitSuffix{"_hz", "Hz"},
                                  UnitSuffix{"_px", "px"},
                                  UnitSuffix{"_fps", "1/s"},
                                  UnitSuffix{"_s", "s"},
                                  UnitSuffix{"_m", "m"}};

std::string shown_unit(std::string_view unit) {
  const std::string lower = ascii_lower(unit);
  if (lower == "deg" || lower == "degree" || lower == "degrees") return "\u00B0";
  if (lower == "seconds" || lower == "sec") return "s";
  return std::string(unit);
}

// "time [s]", "time (s)".
bool split_brackets(std::string_view text, char open, char close, ColumnName& name) {
  if (text.empty() || text.back() != close) return false;
  const std::size_t at = text.rfind(open);
  if (at == std::string_view::npos || at == 0) return false;
  const std::string_view label = trimmed(text.substr(0, at));
  const std::string_view unit = trimmed(text.substr(at + 1, text.size() - at - 2));
  if (label.empty() || unit.empty() || unit.size() > 16) return false;
  name.label = label;
  name.unit = shown_unit(unit);
  return true;
}

}  // namespace

ColumnName parse_column_name(std::string_view header) {
  ColumnName name;
  name.header = to_utf8(header);
  const std::string_view text = trimmed(name.header);
  name.label = text;
  if (split_brackets(text, '[', ']', name) || split_brackets(text, '(', ')', name)) return name;
  const std::string lower = ascii_lower(text);
  for (const UnitSuffix& known : kSuffixes) {
    if (lower.size() <= known.suffix.size() || !lower.ends_with(known.suffix)) continue;
    name.label = text.substr(0, text.size() - known.suffix.size());
    name.unit = known.unit;
    std::replace(name.label.begin(), name.label.end(), '_', ' ');
    break;
  }
  return name;
}

}  // namespace krok::csv
