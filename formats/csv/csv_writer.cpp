#include "formats/csv/csv_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <vector>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/field.h"

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

}  // namespace krok::csv
