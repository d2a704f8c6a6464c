#include "tools/krok-ragdoll/fall.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/table.h"
#include "tools/cli/paths.h"

namespace krok::cli::ragdoll {

namespace {

constexpr double kLatest = 1e6;  // seconds
constexpr std::size_t kMaxFalls = 100'000;

enum Column : unsigned char { name, at_time, joint, x, y, z, time };
const std::array<std::string, 7> kColumns = {"name", "at", "joint", "x", "y", "z", "time"};

bool is_time(std::size_t column) {
  return column == at_time || column == time;
}
bool is_word(std::size_t column) {
  return column == name || column == joint;
}

class TableReader {
 public:
  explicit TableReader(const csv::Table& table) : table_(table) {}

  Result<std::vector<TableFall>> read();

 private:
  Error column_error(std::size_t column, std::string message, std::string hint) const {
    Error error("pushes-column", std::move(message), std::move(hint));
    error.where = table_.header_location(column);
    return error;
  }
  Error cell_error(std::string code, std::size_t row, Column which, std::string message,
                   std::string hint = {}) const {
    Error error(std::move(code), std::move(message), std::move(hint));
    error.where = table_.place(row, at(places_[which]));
    return error;
  }
  Status find_columns();
  Result<double> factor_of(std::size_t which, std::size_t column) const;
  Status read_words(std::vector<TableFall>& falls) const;
  Result<double> number(std::size_t row, Column which, const std::string& cell, double least,
                        double most) const;
  Status read_numbers(std::vector<TableFall>& falls) const;

  const csv::Table& table_;
  std::array<int, 7> places_ = {-1, -1, -1, -1, -1, -1, -1};
  std::array<double, 7> factors_ = {1, 1, 1, 1, 1, 1, 1};
};

Result<double> TableReader::factor_of(std::size_t which, std::size_t column) const {
  const std::string& unit = table_.columns()[column].unit;
  if (unit.empty()) return 1.0;
  if (is_time(which) && unit == "s") return 1.0;
  if (is_time(which) && unit == "ms") return 0.001;
  if (!is_time(which) && !is_word(which) && (unit == "Ns" || unit == "N s")) return 1.0;
  return column_error(column, fmt::format("'{}' has the unit {}", kColumns[which], shown(unit)),
                      is_word(which)   ? "it has none"
                      : is_time(which) ? "use s or ms"
                                       : "use Ns, newton seconds");
}

Status TableReader::find_columns() {
  for (std::size_t c = 0; c < table_.columns().size(); ++c) {
    const std::string label = ascii_lower(trimmed(table_.columns()[c].label));
    const auto found = std::ranges::find(kColumns, label);
    if (found == kColumns.end()) {
      return column_error(
          c, fmt::format("the column '{}' is not known", shown(table_.columns()[c].header)),
          nearest_hint(label, std::vector<std::string>(kColumns.begin(), kColumns.end())));
    }
    const auto which = static_cast<std::size_t>(found - kColumns.begin());
    if (places_[which] >= 0) {
      return column_error(c, fmt::format("there are two columns '{}'", label),
                          "leave one of them out");
    }
    const auto factor = factor_of(which, c);
    if (!factor) return factor.error();
    places_[which] = static_cast<int>(c);
    factors_[which] = *factor;
  }
  for (std::size_t which = 0; which < kColumns.size(); ++which) {
    if (places_[which] >= 0 || which == time) continue;
    return column_error(0, fmt::format("there is no column '{}'", kColumns[which]),
                        "the columns are name, at, joint, x, y, z and maybe time");
  }
  return {};
}

Status TableReader::read_words(std::vector<TableFall>& falls) const {
  const auto names = table_.texts(at(places_[name])), joints = table_.texts(at(places_[joint]));
  std::map<std::string, std::size_t> rows;
  std::set<std::string> files;
  for (std::size_t row = 0; row < falls.size(); ++row) {
    TableFall& fall = falls[row];
    fall.name = std::string(trimmed(names[row]));
    fall.push.joint = std::string(trimmed(joints[row]));
    if (fall.name.empty()) return cell_error("pushes-value", row, name, "the name is empty");
    if (fall.push.joint.empty()) {
      return cell_error("pushes-value", row, joint, "the joint is empty",
                        "a fall without a push has x, y and z of 0");
    }
    const auto [before, is_new] = rows.emplace(fall.name, row);
    if (!is_new) {
      return cell_error("pushes-name", row, name,
                        fmt::format("'{}' is the name of line {} too", shown(fall.name),
                                    table_.place(before->second, at(places_[name])).line),
                        "each fall has a file of its own");
    }
    fall.file_name = file_name_of(fall.name);
    if (!files.insert(fall.file_name).second) {
      return cell_error("pushes-name", row, name,
                        fmt::format("another name gives the file name {} too", fall.file_name),
                        "give one of them another name");
    }
    fall.joint_place = table_.place(row, at(places_[joint]));
    fall.at_place = table_.place(row, at(places_[at_time]));
    fall.time_place = places_[time] < 0 ? fall.at_place : table_.place(row, at(places_[time]));
  }
  return {};
}

Result<double> TableReader::number(std::size_t row, Column which, const std::string& cell,
                                   double least, double most) const {
  const auto value = parse_finite(trimmed(cell));
  if (!value) {
    return cell_error("pushes-value", row, which,
                      trimmed(cell).empty() ? fmt::format("'{}' is empty", kColumns[which])
                                            : fmt::format("'{}' of '{}' is no finite number",
                                                          shown(cell), kColumns[which]),
                      "units are in the header: at [ms], x [Ns]");
  }
  const double number = *value * factors_[which];
  if (number >= least && number <= most) return number;
  return cell_error("pushes-value", row, which,
                    fmt::format("'{}' is {}, expected {} to {}", kColumns[which], readable(number),
                                readable(least), readable(most)));
}

Status TableReader::read_numbers(std::vector<TableFall>& falls) const {
  for (const Column which : {at_time, x, y, z, time}) {
    if (places_[which] < 0) continue;
    const auto cells = table_.texts(at(places_[which]));
    for (std::size_t row = 0; row < falls.size(); ++row) {
      TableFall& fall = falls[row];
      // No time: at the begin of the fall.
      if (which == time && trimmed(cells[row]).empty()) continue;
      const auto value = number(row, which, cells[row], is_time(which) ? 0 : -kMaxImpulse,
                                is_time(which) ? kLatest : kMaxImpulse);
      if (!value) return value.error();
      if (which == at_time) {
        fall.at.value = *value;
      } else if (which == time) {
        fall.push.timed = true;
        fall.push.time.value = *value;
      } else {
        fall.push.impulse[which - x] = *value;
      }
    }
  }
  return {};
}

Result<std::vector<TableFall>> TableReader::read() {
  if (Status status = find_columns(); !status) return status.error();
  if (table_.row_count() > kMaxFalls) {
    return Error("pushes-value", fmt::format("the table has {} rows, at most {} can be",
                                             table_.row_count(), kMaxFalls));
  }
  std::vector<TableFall> falls(table_.row_count());
  if (Status status = read_words(falls); !status) return status.error();
  if (Status status = read_numbers(falls); !status) return status.error();
  return falls;
}

}  // namespace

Result<std::vector<TableFall>> read_push_table(std::string_view text, const std::string& path) {
  const auto table = csv::Table::read(text, path);
  if (!table) return table.error();
  auto falls = TableReader(*table).read();
  if (!falls) return std::move(falls).error().in_file(path);
  return falls;
}

}  // namespace krok::cli::ragdoll
