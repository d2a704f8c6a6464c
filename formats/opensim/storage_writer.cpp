#include "formats/opensim/storage_writer.h"

#include <fmt/format.h>

#include <cmath>

#include "core/numbers.h"

namespace krok::opensim {

namespace {

std::string label(std::string name) {
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  return name.empty() ? "_" : name;
}

}  // namespace

Status write(const csv::SeriesTable& table, const std::string& name, bool degrees,
             OutputFile& file) {
  std::string text =
      fmt::format("{}\nversion=1\nnRows={}\nnColumns={}\ninDegrees={}\nendheader\n", label(name),
                  table.frames, table.columns() + 1, degrees ? "yes" : "no");
  text += "time";
  for (const std::string& item : table.items) {
    for (const std::string& quantity : table.quantities) {
      text += '\t';
      text += label(table.quantities.size() == 1 ? item : item + "_" + quantity);
    }
  }
  text += '\n';
  const auto add = [&](int frame, std::span<const float> row) -> Status {
    text += shortest(frame / table.rate);
    for (const float value : row) {
      text += '\t';
      text += std::isfinite(value) ? shortest(value) : "nan";
    }
    text += '\n';
    if (text.size() < (std::size_t{1} << 20)) return {};
    Status status = file.write(text);
    text.clear();
    return status;
  };
  if (Status status = table.for_each_row(add); !status) return status;
  return file.write(text);
}

}  // namespace krok::opensim
