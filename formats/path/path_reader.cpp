#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/numbers.h"
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

namespace {

constexpr std::size_t kDeepest = 256;  // elements within elements

// A start or end tag.
struct Tag {
  std::string_view name;  // without a prefix
  bool ends = false;      // </name>
  bool empty = false;     // <name/>
  // Of these attributes, the values as written, and where they begin.
  std::string_view d, points, id, transform;
  std::size_t d_at = 0, points_at = 0, transform_at = 0;
};

std::string_view local_name(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

// Walks over the tags of an XML text; everything else is left out.
class TagScanner {
 public:
  explicit TagScanner(std::string_view text) : text_(text) {}

  std::size_t offset() const { return at_; }

  // False at the end, and at what is no XML: then broken() is true.
  bool next(Tag& tag) {
    while (true) {
      at_ = text_.find('<', at_);
      if (at_ == std::string_view::npos) return false;
      const std::string_view rest = text_.substr(at_);
      if (rest.starts_with("<!--")) {
        if (!skip_past("-->")) return false;
      } else if (rest.starts_with("<![CDATA[")) {
        if (!skip_past("]]>")) return false;
      } else if (rest.starts_with("<?")) {
        if (!skip_past("?>")) return false;
      } else if (rest.starts_with("<!")) {
        if (!skip_past(">")) return false;
      } else {
        return read(tag);
      }
    }
  }
  bool broken() const { return broken_; }

 private:
  bool skip_past(std::string_view end) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) return !(broken_ = true);
    at_ = found + end.size();
    return true;
  }

  bool read(Tag& tag) {
    tag = {};
    std::size_t at = at_ + 1;
    const auto fail = [&] { return !(broken_ = true); };
    const auto space = [&] {
      while (at < text_.size() && is_space(text_[at])) ++at;
    };
    const auto word = [&] {
      const std::size_t begin = at;
      while (at < text_.size() && !is_space(text_[at]) &&
             std::string_view("=/><").find(text_[at]) == std::string_view::npos) {
        ++at;
      }
      return local_name(text_.substr(begin, at - begin));
    };
    if (at < text_.size() && text_[at] == '/') {
      tag.ends = true;
      ++at;
    }
    tag.name = word();
    if (tag.name.empty()) return fail();
    while (true) {
      space();
      if (at >= text_.size()) return fail();
      if (text_[at] == '>') break;
      if (text_[at] == '/') {
        tag.empty = true;
        ++at;
        continue;
      }
      const std::string_view name = word();
      space();
      if (name.empty() || at >= text_.size() || text_[at] != '=') return fail();
      ++at;
      space();
      if (at >= text_.size() || (text_[at] != '"' && text_[at] != '\'')) return fail();
      const std::size_t begin = at + 1, end = text_.find(text_[at], begin);
      if (end == std::string_view::npos) return fail();
      keep(tag, name, text_.substr(begin, end - begin), begin);
      at = end + 1;
    }
    at_ = at + 1;
    return true;
  }

  static void keep(Tag& tag, std::string_view name, std::string_view value, std::size_t at) {
    if (name == "d") tag.d = value, tag.d_at = at;
    if (name == "points") tag.points = value, tag.points_at = at;
    if (name == "id") tag.id = value;
    if (name == "transform") tag.transform = value, tag.transform_at = at;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool broken_ = false;
};

Error svg_error(const DataFault& fault, std::size_t begin, std::size_t& place) {
  place = begin + fault.offset;
  return {fault.code, fault.message};
}

}  // namespace

std::optional<DataFault> read_transform(std::string_view text, Affine2& transform) {
  NumberScanner in(text);
  transform = Affine2::Identity();
  while (!in.at_end()) {
    const std::size_t begin = in.offset();
    while (in.peek() != '(' && in.offset() < text.size()) in.take();
    const std::string_view name = trimmed(text.substr(begin, in.offset() - begin));
    if (in.offset() >= text.size()) return DataFault{begin, "a transform has no brackets"};
    in.take();
    std::array<double, 6> v{};
    std::size_t count = 0;
    in.skip_space();
    while (in.peek() != ')') {
      const auto value = count < v.size() ? in.number() : std::nullopt;
      if (!value) return DataFault{in.offset(), "a transform has something else than numbers"};
      v[count++] = *value;
      in.skip_comma();
    }
    in.take();
    Affine2 one = Affine2::Identity();
    if (name == "translate" && (count == 1 || count == 2)) {
      one.translate(Vec2(v[0], v[1]));
    } else if (name == "scale" && (count == 1 || count == 2)) {
      one.scale(Vec2(v[0], count == 1 ? v[0] : v[1]));
    } else if (name == "rotate" && (count == 1 || count == 3)) {
      one.translate(Vec2(v[1], v[2]));
      one.rotate(v[0] * kRadiansPerDegree);
      one.translate(-Vec2(v[1], v[2]));
    } else if (name == "skewX" && count == 1) {
      one.linear()(0, 1) = std::tan(v[0] * kRadiansPerDegree);
    } else if (name == "skewY" && count == 1) {
      one.linear()(1, 0) = std::tan(v[0] * kRadiansPerDegree);
    } else if (name == "matrix" && count == 6) {
      one.linear() << v[0], v[2], v[1], v[3];
      one.translation() << v[4], v[5];
    } else {
      return DataFault{begin,
                       fmt::format("'{}' with {} numbers is no transform", shown(name), count)};
    }
    transform = transform * one;
    in.skip_comma();
  }
  return {};
}

Result<std::vector<Vec2>> read_svg(std::string_view text, double metres_per_unit,
                                   const std::string& id, std::size_t& fault_place) {
  TagScanner tags(text);
  Affine2 base = Affine2::Identity();
  base.scale(metres_per_unit);
  std::vector<Affine2> transforms = {base};  // of the open elements
  std::size_t hidden = 0;                    // how deep in what is not drawn
  std::size_t others = 0;
  Tag tag;
  while (tags.next(tag)) {
    if (tag.ends) {
      if (transforms.size() > 1) transforms.pop_back();
      if (hidden > 0) --hidden;
      continue;
    }
    Affine2 own = Affine2::Identity();
    if (auto fault = read_transform(tag.transform, own)) {
      return svg_error(*fault, tag.transform_at, fault_place);
    }
    const Affine2 to_metres = transforms.back() * own;
    const bool not_drawn = tag.name == "defs" || tag.name == "clipPath" || tag.name == "symbol" ||
                           tag.name == "marker" || tag.name == "mask" || tag.name == "pattern";
    const bool is_path = tag.name == "path" && !tag.d.empty();
    const bool is_line = tag.name == "polyline" && !tag.points.empty();
    if (is_path || is_line) ++others;
    if ((is_path || is_line) && (id.empty() ? hidden == 0 : tag.id == id)) {
      std::vector<Vec2> points;
      const auto fault = is_path ? read_path_data(tag.d, to_metres, points)
                                 : read_polyline(tag.points, to_metres, points);
      if (fault) return svg_error(*fault, is_path ? tag.d_at : tag.points_at, fault_place);
      return points;
    }
    if (tag.empty) continue;
    if (transforms.size() >= kDeepest) {
      fault_place = tags.offset();
      return Error("path-svg", "elements are nested too deeply");
    }
    transforms.push_back(to_metres);
    if (hidden > 0 || not_drawn) ++hidden;
  }
  fault_place = tags.broken() ? tags.offset() : 0;
  if (tags.broken()) return Error("path-svg", "the file is no well-formed XML from here on");
  if (!id.empty()) {
    return Error("path-svg",
                 fmt::format("no path or polyline has the id '{}' (of {})", shown(id), others));
  }
  return Error("path-svg", "the file draws no path and no polyline",
               "convert the shape to a path in the drawing program");
}

}  // namespace krok::path_file
