#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/nearest_name.h"
#include "core/numbers.h"
#include "core/quantity.h"
#include "core/text.h"
#include "formats/csv/table.h"
#include "formats/json/members.h"
#include "formats/prints/prints.h"

namespace krok::prints {

namespace {

using gait::Print;

constexpr double kFarthest = 1e6;  // metres
constexpr double kLatest = 1e6;    // seconds
constexpr double kMaxTurn = 1e4;   // radians: many times round

// A value of a print by its name in files.
struct Field {
  std::string name;
  std::string unit;  // where none is given
  bool needed;
  double most;  // least is -most
  // The number of `text`, or an error if it has a unit of another kind.
  Result<double> (*parse)(std::string_view text);
  void (*set)(Print& print, double value);
};

Result<double> parse_seconds(std::string_view text) {
  const auto time = parse_clip_time(text);
  if (!time) return time.error();
  if (time->in_frames) return Error("quantity-unit", "the unit cannot be frames", "use s or ms");
  return time->value;
}

const std::array<Field, 5>& fields() {
  static const std::array<Field, 5> kFields = {{
      {"x", "m", true, kFarthest, parse_length, [](Print& p, double v) { p.x = v; }},
      {"z", "m", true, kFarthest, parse_length, [](Print& p, double v) { p.z = v; }},
      {"heading", "deg", true, kMaxTurn, parse_angle, [](Print& p, double v) { p.heading = v; }},
      {"height", "m", false, kFarthest, parse_length, [](Print& p, double v) { p.height = v; }},
      {"time", "s", false, kLatest, parse_seconds, [](Print& p, double v) { p.time = v; }},
  }};
  return kFields;
}

std::optional<FootSide> side_of(std::string_view word) {
  if (same_word(word, "left") || same_word(word, "l")) return FootSide::left;
  if (same_word(word, "right") || same_word(word, "r")) return FootSide::right;
  return std::nullopt;
}

// Checks what concerns several prints; `place` gives where print `index` has its side or its time.
Status check_order(std::span<const Print> prints,
                   const std::function<Location(std::size_t index, bool time)>& place) {
  std::optional<std::size_t> timed;
  for (std::size_t i = 0; i < prints.size(); ++i) {
    if (i > 0 && prints[i].side == prints[i - 1].side) {
      Error error("prints-order",
                  fmt::format("print {} is a {} one, as print {} before it", i + 1,
                              name_of(prints[i].side), i),
                  "left and right must alternate");
      error.where = place(i, false);
      return error;
    }
    if (!prints[i].time) continue;
    if (timed && !(*prints[i].time > *prints[*timed].time)) {
      Error error(
          "prints-order",
          fmt::format("print {} is at {} s, not after print {} at {} s", i + 1,
                      readable(*prints[i].time), *timed + 1, readable(*prints[*timed].time)),
          "times must rise");
      error.where = place(i, true);
      return error;
    }
    timed = i;
  }
  return {};
}

class CsvReader {
 public:
  CsvReader(const csv::Table& table, const std::string& path) : table_(table), path_(path) {}

  Result<std::vector<Print>> read() {
    if (Status status = find_columns(); !status) return status.error();
    std::vector<Print> prints(table_.row_count());
    const std::vector<std::string> sides = table_.texts(side_);
    for (std::size_t row = 0; row < prints.size(); ++row) {
      const auto side = side_of(trimmed(sides[row]));
      if (!side) {
        return wrong(row, side_, fmt::format("'{}' is no side", shown(sides[row])),
                     "write left or right");
      }
      prints[row].side = *side;
    }
    std::vector<std::size_t> columns;
    for (const Used& used : used_) columns.push_back(used.column);
    const auto values = table_.numbers(columns);
    if (!values) return values.error();
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (Status status = take(used_[i], (*values)[i], prints); !status) return status.error();
    }
    const Status order = check_order(prints, [&](std::size_t row, bool time) {
      return table_.place(row, time ? time_ : side_);
    });
    if (!order) return order.error();
    return prints;
  }

 private:
  struct Used {
    const Field* field;
    std::size_t column;
    double factor;
  };

  Error wrong(std::size_t row, std::size_t column, std::string message, std::string hint) const {
    Error error("prints-value", std::move(message), std::move(hint));
    error.where = table_.place(row, column);
    return error;
  }

  Error column_error(std::size_t column, std::string message, std::string hint = {}) const {
    Error error("prints-column", std::move(message), std::move(hint));
    error.where = table_.header_location(column);
    return error;
  }

  Status find_columns() {
    std::vector<std::string> names = {"side"};
    for (const Field& field : fields()) names.push_back(field.name);
    std::vector<std::uint8_t> seen(names.size(), 0);
    for (std::size_t c = 0; c < table_.columns().size(); ++c) {
      const csv::ColumnName& name = table_.columns()[c];
      const std::string label = ascii_lower(name.label);
      const auto found = std::find(names.begin(), names.end(), label);
      if (found == names.end()) {
        return column_error(c, fmt::format("'{}' is no column of footprints", shown(name.header)),
                            nearest_hint(label, names));
      }
      const auto index = static_cast<std::size_t>(found - names.begin());
      if (seen[index] != 0) return column_error(c, fmt::format("a second column '{}'", label));
      seen[index] = 1;
      if (index == 0) {
        side_ = c;
        continue;
      }
      const Field& field = fields()[index - 1];
      const auto factor = field.parse("1" + (name.unit.empty() ? field.unit : name.unit));
      if (!factor) return column_error(c, factor.error().message, factor.error().hint);
      if (field.name == "time") time_ = c;
      used_.push_back({&field, c, *factor});
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (seen[i] != 0 || (i > 0 && !fields()[i - 1].needed)) continue;
      return Error("prints-column", fmt::format("there is no column '{}'", names[i]),
                   "the first line names the columns: side,x,z,heading and optionally height,time")
          .in_file(path_)
          .at_line(1);
    }
    return {};
  }

  Status take(const Used& used, const std::vector<double>& values, std::vector<Print>& prints) {
    const Field& field = *used.field;
    for (std::size_t row = 0; row < values.size(); ++row) {
      const double value = values[row] * used.factor;
      if (std::isnan(value)) {
        // An empty cell of an optional column is a print without; NaN written out is a mistake.
        if (!field.needed && is_empty(row, used.column)) continue;
        return wrong(row, used.column,
                     fmt::format("print {} has no number as its {}", row + 1, field.name),
                     field.needed ? "" : "leave the cell empty if there is none");
      }
      if (!(std::abs(value) <= field.most)) {
        return wrong(
            row, used.column,
            fmt::format("the {} of print {} is {}", field.name, row + 1, readable(values[row])),
            fmt::format("expected at most {} {}", readable(field.most),
                        field.unit == "deg" ? "rad" : field.unit));
      }
      field.set(prints[row], value);
    }
    return {};
  }

  bool is_empty(std::size_t row, std::size_t column) {
    if (cells_of_ != column || cells_.empty()) {
      cells_ = table_.texts(column);
      cells_of_ = column;
    }
    return trimmed(cells_[row]).empty();
  }

  const csv::Table& table_;
  const std::string& path_;
  std::size_t side_ = 0, time_ = 0;
  std::vector<Used> used_;
  std::vector<std::string> cells_;
  std::size_t cells_of_ = 0;
};

class JsonReader {
 public:
  explicit JsonReader(std::string_view text) : text_(text), members_(text, "prints") {}

  Result<std::vector<Print>> read() {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    Status status = members_.only(*root, "the file", {"schema", "comment", "prints"});
    if (!status) return status.error();
    status = members_.has_schema(*root, "the file", "krok.prints/1");
    if (!status) return status.error();
    const auto list = members_.get(*root, "the file", "prints", json::Value::Kind::array);
    if (!list) return list.error();
    std::vector<Print> prints;
    for (const json::Value& item : (*list)->items) {
      auto print = read_print(item);
      if (!print) return print.error();
      prints.push_back(*print);
    }
    status = check_order(prints, [&](std::size_t index, bool time) {
      const json::Value& item = (*list)->items[index];
      const json::Value& value = *item.find(time ? "time" : "side");
      return json::error_at(text_, value.offset, {}, {}).where;
    });
    if (!status) return status.error();
    return prints;
  }

 private:
  Result<Print> read_print(const json::Value& item) const {
    constexpr std::string_view kWhat = "a print";
    Status status =
        members_.only(item, kWhat, {"side", "x", "z", "heading", "height", "time", "comment"});
    if (!status) return status.error();
    Print print;
    const auto side = members_.get(item, kWhat, "side", json::Value::Kind::string);
    if (!side) return side.error();
    const auto which = side_of((*side)->text);
    if (!which) {
      return members_.wrong(**side, fmt::format("'{}' is no side", shown((*side)->text)),
                            "write left or right");
    }
    print.side = *which;
    for (const Field& field : fields()) {
      const auto value = members_.quantity(item, kWhat, field.name, field.parse);
      if (!value) return value.error();
      if (!*value) {
        if (!field.needed) continue;
        return members_.structure(item, fmt::format("a print is missing \"{}\"", field.name));
      }
      if (!(std::abs(**value) <= field.most)) {
        return members_.wrong(*item.find(field.name),
                              fmt::format("\"{}\" of a print is too large", field.name));
      }
      field.set(print, **value);
    }
    return print;
  }

  std::string_view text_;
  json::Members members_;
};

}  // namespace

Result<std::vector<Print>> read(std::string_view text, const std::string& path) {
  const std::string_view begin = trimmed(without_byte_order_mark(text).substr(0, 256));
  if (begin.starts_with('{')) {
    auto prints = JsonReader(text).read();
    if (!prints) return std::move(prints.error()).in_file(path);
    return prints;
  }
  const auto table = csv::Table::read(text, path);
  if (!table) return table.error();
  return CsvReader(*table, path).read();
}

}  // namespace krok::prints
