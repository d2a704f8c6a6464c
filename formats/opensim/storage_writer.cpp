#include "formats/opensim/storage_writer.h"

#include <fmt/format.h>

#include <cassert>
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
  assert(table.values.size() == static_cast<std::size_t>(table.frames) * table.columns());
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
  const float* value = table.values.data();
  for (int frame = 0; frame < table.frames; ++frame) {
    text += shortest(frame / table.rate);
    for (std::size_t c = 0; c < table.columns(); ++c, ++value) {
      text += '\t';
      text += std::isfinite(*value) ? shortest(*value) : "nan";
    }
    text += '\n';
    if (text.size() < (std::size_t{1} << 20)) continue;
    if (Status status = file.write(text); !status) return status;
    text.clear();
  }
  return file.write(text);
}

}  // namespace krok::opensim
