#include "formats/prints/prints.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/table.h"
#include "formats/json/fields.h"

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

const std::array<Field, 5>& fields() {
  static const std::array<Field, 5> kFields = {{
      {"x", "m", true, kFarthest, parse_length, [](Print& p, double v) { p.x = v; }},
      {"z", "m", true, kFarthest, parse_length, [](Print& p, double v) { p.z = v; }},
      {"heading", "deg", true, kMaxTurn, parse_angle, [](Print& p, double v) { p.heading = v; }},
      {"height", "m", false, kFarthest, parse_length, [](Print& p, double v) { p.height = v; }},
      {"time", "s", false, kLatest, json::parse_seconds, [](Print& p, double v) { p.time = v; }},
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

using Prints = std::vector<Print>;

json::Object<Print> print_table() {
  json::Object<Print> print;
  print
      .field("side", &Print::side,
             json::kind<FootSide>(R"({"enum": ["left", "right", "l", "r"]})",
                                  [](const json::Given& given, FootSide& to) -> Status {
                                    Status status = given.is(json::Value::Kind::string);
                                    if (!status) return status;
                                    const auto side = side_of(given.value.text);
                                    to = side.value_or(to);
                                    if (side) return {};
                                    return given.wrong(
                                        fmt::format("'{}' is no side", shown(given.value.text)),
                                        "write left or right");
                                  }))
      .required();
  for (const Field& field : fields()) {
    const auto value = json::quantity(field.parse, field.unit);
    print.field(field.name,
                json::kind<Print>(
                    value.schema(), [&field, value](const json::Given& given, Print& to) -> Status {
                      double number = 0;
                      if (Status status = value.read(given, &number); !status) return status;
                      field.set(to, number);
                      if (std::abs(number) <= field.most) return {};
                      return given.wrong(fmt::format("{} is too large", given.name()));
                    }));
    if (field.needed) print.required();
  }
  return print.comment();
}

json::Object<Prints> table() {
  json::Object<Prints> file;
  file.file("krok.prints/1", "Footprints (krok.prints/1)").comment();
  file.field("prints", json::list<Print>(json::object(print_table()), {"a print"})).required();
  file.check([](const json::Given& root, const Prints& prints) -> Status {
    Status status = check_order(prints, [&](std::size_t index, bool time) {
      const json::Value& item = root.value.find("prints")->items[index];
      return json::Given{root.source, *item.find(time ? "time" : "side"), {}, {}}
          .error({}, {})
          .where;
    });
    return status;
  });
  return file;
}

// Up to six decimals, without trailing zeros or negative zero.
std::string six_decimals(double value) {
  std::string text = fmt::format("{:.6f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string degrees(const gait::Print& print) {
  return six_decimals(print.heading / kRadiansPerDegree);
}

}  // namespace

Result<std::vector<Print>> read(std::string_view text, const std::string& path) {
  const std::string_view begin = trimmed(without_byte_order_mark(text).substr(0, 256));
  if (begin.starts_with('{') || begin.starts_with('[')) {
    auto prints = table().read_text(text, "prints");
    if (!prints) return std::move(prints.error()).in_file(path);
    return prints;
  }
  const auto table = csv::Table::read(text, path);
  if (!table) return table.error();
  return CsvReader(*table, path).read();
}

Status write_csv(std::span<const gait::Print> prints, OutputFile& file) {
  const bool heights = std::ranges::any_of(prints, [](const auto& one) { return !!one.height; });
  const bool times = std::ranges::any_of(prints, [](const auto& one) { return !!one.time; });
  std::string text = "side,x [m],z [m],heading [deg]";
  if (heights) text += ",height [m]";
  if (times) text += ",time [s]";
  text += '\n';
  for (const gait::Print& print : prints) {
    text += fmt::format("{},{},{},{}", name_of(print.side), six_decimals(print.x),
                        six_decimals(print.z), degrees(print));
    if (heights) text += ',' + (print.height ? six_decimals(*print.height) : std::string());
    if (times) text += ',' + (print.time ? six_decimals(*print.time) : std::string());
    text += '\n';
  }
  return file.write(text);
}

Status write_json(std::span<const gait::Print> prints, OutputFile& file) {
  std::string text = "{\n  \"schema\": \"krok.prints/1\",\n  \"prints\": [";
  const char* between = "\n";
  for (const gait::Print& print : prints) {
    text += fmt::format("{}    {{\"side\": \"{}\", \"x\": {}, \"z\": {}, \"heading\": {}", between,
                        name_of(print.side), six_decimals(print.x), six_decimals(print.z),
                        degrees(print));
    if (print.height) text += ", \"height\": " + six_decimals(*print.height);
    if (print.time) text += ", \"time\": " + six_decimals(*print.time);
    text += '}';
    between = ",\n";
  }
  text += prints.empty() ? "]\n}\n" : "\n  ]\n}\n";
  return file.write(text);
}

std::string schema() {
  return table().schema();
}

}  // namespace krok::prints
