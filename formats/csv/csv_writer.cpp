#include "formats/csv/csv_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/numbers.h"
#include "formats/csv/table.h"

namespace krok::csv {

namespace {

constexpr std::size_t kFlushBytes = std::size_t{1} << 20;

void add_value(float value, std::string& text) {
  text += ',';
  if (std::isfinite(value)) text += shortest(value);
}

// What each row begins with.
std::string start_of_row(const FileColumn& motion) {
  return motion.name.empty() ? std::string() : field(to_utf8(motion.name)) + ",";
}

std::string header_of(const FileColumn& motion, const std::string& columns) {
  if (!motion.with_header) return {};
  return (motion.name.empty() ? "" : "file,") + columns + "\n";
}

Status flush_long_text(std::string& text, OutputFile& file) {
  if (text.size() < kFlushBytes) return {};
  Status status = file.write(text);
  text.clear();
  return status;
}

}  // namespace

Status write(const FrameSource& motion, OutputFile& file) {
  std::vector<std::string> names;
  for (const std::string& name : motion.skeleton.names) names.push_back(field(name));

  std::string text = "frame,time,joint,x,y,z\n";
  const auto add = [&](int first, const Clip& block) {
    Status status = check_values(motion.skeleton, first, block.positions, block.orientations);
    if (!status) return status;
    for (int f = 0; f < block.frame_count(); ++f) {
      const int frame = first + f;
      const std::string start = fmt::format("{},{},", frame, shortest(frame / motion.rate));
      const auto positions = block.frame_positions(f);
      for (std::size_t j = 0; j < names.size(); ++j) {
        text += start;
        text += names[j];
        for (int axis = 0; axis < 3; ++axis) {
          text += ',';
          text += shortest(positions[j][axis]);
        }
        text += '\n';
      }
    }
    return flush_long_text(text, file);
  };
  if (Status status = for_each_block(motion, 1, add); !status) return status;
  return file.write(text);
}

Status write(std::span<const Contact> contacts, std::span<const std::string> names,
             const FileColumn& motion, OutputFile& file) {
  std::string text = header_of(motion, "joint,start,end,x,y,z");
  for (const Contact& contact : contacts) {
    text += fmt::format("{}{},{},{}", start_of_row(motion),
                        field(names[static_cast<std::size_t>(contact.joint)]),
                        shortest(contact.start), shortest(contact.end));
    for (int axis = 0; axis < 3; ++axis) (text += ',') += shortest(contact.place[axis]);
    text += '\n';
  }
  return file.write(text);
}

Status write(const MorphWeights& weights, OutputFile& file) {
  std::string text = "frame,time";
  for (const std::string& name : weights.names) (text += ',') += field(name);
  text += '\n';
  for (int frame = 0; frame < weights.frame_count(); ++frame) {
    text += fmt::format("{},{}", frame, shortest(frame / weights.rate));
    for (std::size_t t = 0; t < weights.names.size(); ++t) {
      text += ',';
      text += shortest(weights.values[static_cast<std::size_t>(frame) * weights.names.size() + t]);
    }
    text += '\n';
  }
  return file.write(text);
}

Status SeriesTable::for_each_row(
    const std::function<Status(int frame, std::span<const float> row)>& use) const {
  constexpr int kFrames = 4096;
  for (int first = 0; first < frames; first += kFrames) {
    const int count = std::min(kFrames, frames - first);
    const auto block = values(first, count);
    if (!block) return block.error();
    assert(block->size() == static_cast<std::size_t>(count) * columns());
    std::span<const float> rest = *block;
    for (int f = 0; f < count; ++f, rest = rest.subspan(columns())) {
      if (Status status = use(first + f, rest.first(columns())); !status) return status;
    }
  }
  return {};
}

Status write_long(const SeriesTable& table, const FileColumn& motion, OutputFile& file) {
  std::vector<std::string> names;
  for (const std::string& item : table.items) names.push_back(field(item));
  std::string columns = "frame,time," + field(table.item_name);
  for (const std::string& quantity : table.quantities) (columns += ',') += field(quantity);
  std::string text = header_of(motion, columns);
  const std::string row = start_of_row(motion);
  const auto add = [&](int frame, std::span<const float> values) {
    const std::string start = fmt::format("{}{},{},", row, frame, shortest(frame / table.rate));
    const float* value = values.data();
    for (const std::string& name : names) {
      text += start + name;
      for (std::size_t q = 0; q < table.quantities.size(); ++q) add_value(*value++, text);
      text += '\n';
    }
    return flush_long_text(text, file);
  };
  if (Status status = table.for_each_row(add); !status) return status;
  return file.write(text);
}

Status write_wide(const SeriesTable& table, const FileColumn& motion, OutputFile& file) {
  std::string columns = "frame,time";
  for (const std::string& item : table.items) {
    for (const std::string& quantity : table.quantities) {
      columns += ',';
      columns += field(table.quantities.size() == 1 ? item : fmt::format("{}.{}", item, quantity));
    }
  }
  std::string text = header_of(motion, columns);
  const std::string row = start_of_row(motion);
  const auto add = [&](int frame, std::span<const float> values) {
    text += fmt::format("{}{},{}", row, frame, shortest(frame / table.rate));
    for (const float value : values) add_value(value, text);
    text += '\n';
    return flush_long_text(text, file);
  };
  if (Status status = table.for_each_row(add); !status) return status;
  return file.write(text);
}

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
