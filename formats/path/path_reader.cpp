#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/quantity.h"
#include "core/text.h"
#include "formats/csv/table.h"
#include "formats/json/fields.h"
#include "formats/path/path_data_internal.h"
#include "formats/path/path_format.h"

namespace krok::path_file {

namespace {

using gait::PathPoint;
using Points = Result<std::vector<PathPoint>>;

std::vector<PathPoint> without_times(const std::vector<Vec2>& points) {
  std::vector<PathPoint> way;
  way.reserve(points.size());
  for (const Vec2& point : points) way.push_back({point.x(), point.y(), {}});
  return way;
}

Points read_csv_path(std::string_view text, const std::string& path) {
  const auto table = csv::Table::read(text, path);
  if (!table) return table.error();
  if (table->row_count() > kMaxPoints) {
    return Error("path-limit", fmt::format("the way has more than {} points", kMaxPoints))
        .in_file(path);
  }
  const std::vector<std::string> names = {"x", "z", "time"};
  std::array<std::optional<std::size_t>, 3> columns;
  std::array<double, 3> factors = {1, 1, 1};
  for (std::size_t c = 0; c < table->columns().size(); ++c) {
    const csv::ColumnName& name = table->columns()[c];
    const auto found = std::ranges::find(names, ascii_lower(name.label));
    const auto k = static_cast<std::size_t>(found - names.begin());
    Error error("path-column", {});
    error.where = table->header_location(c);
    if (found == names.end()) {
      error.message = fmt::format("'{}' is no column of a way", shown(name.header));
      error.hint = nearest_hint(name.label, names);
      return error;
    }
    if (columns[k]) {
      error.message = fmt::format("a second column '{}'", names[k]);
      return error;
    }
    columns[k] = c;
    if (name.unit.empty()) continue;
    const auto factor =
        k < 2 ? parse_length("1" + name.unit) : json::parse_seconds("1" + name.unit);
    if (!factor) {
      error.message = factor.error().message;
      error.hint = factor.error().hint;
      return error;
    }
    factors[k] = *factor;
  }
  if (!columns[0] || !columns[1]) {
    return Error("path-column", "a way needs the columns x and z",
                 "the first line names the columns: x,z and optionally time")
        .in_file(path)
        .at_line(1);
  }
  std::vector<std::size_t> used = {*columns[0], *columns[1]};
  if (columns[2]) used.push_back(*columns[2]);
  const auto values = table->numbers(used);
  if (!values) return values.error();
  std::vector<PathPoint> way(table->row_count());
  for (std::size_t row = 0; row < way.size(); ++row) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (!std::isnan((*values)[k][row])) continue;
      Error error("path-value", fmt::format("point {} has no number as its {}", row + 1, names[k]));
      error.where = table->place(row, used[k]);
      return error;
    }
    way[row].x = (*values)[0][row] * factors[0];
    way[row].z = (*values)[1][row] * factors[1];
    if (used.size() > 2 && !std::isnan((*values)[2][row])) {
      way[row].time = (*values)[2][row] * factors[2];
    }
  }
  return way;
}

using Way = std::vector<PathPoint>;

json::Object<Way> table() {
  json::Object<PathPoint> point;
  point.field("x", &PathPoint::x, json::quantity(parse_length, "metres")).required();
  point.field("z", &PathPoint::z, json::quantity(parse_length, "metres")).required();
  point.field("time", &PathPoint::time, json::quantity(json::parse_seconds, "seconds")).comment();
  json::Object<Way> file;
  file.file("krok.path/1", "A way over the ground (krok.path/1)").comment();
  file.field("points", json::list<PathPoint>(json::object(point), {"a point"})).required();
  return file;
}

}  // namespace

Points read(std::string_view text, const std::string& path, const ReadOptions& options) {
  const std::string_view whole = without_byte_order_mark(text);
  std::size_t begin = 0;
  while (begin < whole.size() && is_space(whole[begin])) ++begin;
  const char first = begin < whole.size() ? whole[begin] : '\0';
  const std::size_t skipped = text.size() - whole.size();
  if (first == '<') {
    std::size_t place = 0;
    auto points = read_svg(whole, options.metres_per_unit, options.id, place);
    if (points) return without_times(*points);
    Error error = std::move(points).error();
    error.where = locate(text, place + skipped, path);
    return error;
  }
  if (first == 'M' || first == 'm') {
    Affine2 to_metres = Affine2::Identity();
    to_metres.scale(options.metres_per_unit);
    std::vector<Vec2> points;
    const auto fault = read_path_data(whole, to_metres, points);
    if (!fault) return without_times(points);
    Error error(fault->code, fault->message);
    error.where = locate(text, fault->offset + skipped, path);
    return error;
  }
  if (first == '{' || first == '[') {
    auto way = table().read_text(text, "path");
    if (!way) return std::move(way.error()).in_file(path);
    return way;
  }
  return read_csv_path(text, path);
}

std::string schema() {
  return table().schema();
}

}  // namespace krok::path_file
