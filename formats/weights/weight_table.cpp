#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numbers.h"
#include "formats/csv/table.h"
#include "formats/weights/weights_internal.h"

// Reader for weights as a table: one row per time, one column per target.

namespace krok::weights {

namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

Error at(Error error, const Location& place) {
  error.where = place;
  return error;
}

// The meaning of the columns of a table.
struct Columns {
  std::size_t time = kNone;  // in seconds, or
  std::size_t frame = kNone;
  std::vector<std::size_t> weights;  // columns, and ...
  std::vector<std::size_t> targets;  // ... their targets
};

Result<Columns> find_columns(const csv::Table& table, std::span<const std::string> targets) {
  Columns columns;
  const auto& names = table.columns();
  for (std::size_t c = 0; c < names.size(); ++c) {
    const bool seconds = names[c].unit.empty() || names[c].unit == "s";
    if (columns.frame == kNone && names[c].header == "frame") {
      columns.frame = c;
    } else if (columns.time == kNone && names[c].label == "time" && seconds) {
      columns.time = c;
    } else {
      const auto target = std::ranges::find(targets, names[c].header);
      if (target == targets.end()) {
        return at(unknown_target(names[c].header, targets), table.header_location(c));
      }
      const auto index = static_cast<std::size_t>(target - targets.begin());
      if (std::ranges::find(columns.targets, index) != columns.targets.end()) {
        return at(Error("weights-structure",
                        fmt::format("duplicate column '{}'", shown(names[c].header))),
                  table.header_location(c));
      }
      columns.weights.push_back(c);
      columns.targets.push_back(index);
    }
  }
  if (columns.time == kNone) {
    return at(Error("weights-structure", "there is no column 'time'",
                    "it has times in seconds; krok-import --morph-weights writes such tables"),
              table.header_location(0));
  }
  return columns;
}

Status check_times(const csv::Table& table, std::size_t column, const std::vector<double>& times) {
  for (std::size_t row = 0; row < times.size(); ++row) {
    if (!(times[row] >= 0 && times[row] <= kLatest)) {
      return at(Error("weights-value", fmt::format("the time is {}, expected 0 to {} s",
                                                   std::isnan(times[row]) ? std::string("missing")
                                                                          : readable(times[row]),
                                                   readable(kLatest))),
                table.place(row, column));
    }
    if (row > 0 && !(times[row] > times[row - 1])) {
      return at(
          Error("weights-time", fmt::format("{} s is not after the previous row at {} s",
                                            readable(times[row], 9), readable(times[row - 1], 9))),
          table.place(row, column));
    }
  }
  return {};
}

// The rate if times are i / rate within float precision.
std::optional<double> rate_of(const std::vector<double>& times) {
  if (times.size() < 2 || times[0] != 0) return std::nullopt;
  double rate = static_cast<double>(times.size() - 1) / times.back();
  const double whole = std::round(rate);
  if (whole >= 1 && std::abs(rate - whole) < 1e-6 * whole) rate = whole;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!(std::abs(times[i] * rate - static_cast<double>(i)) < 1e-3)) return std::nullopt;
  }
  return rate >= 1e-3 && rate <= 1e6 ? std::optional(rate) : std::nullopt;
}

}  // namespace

Result<WeightFile> read_table(std::string_view text, const std::string& path,
                              std::span<const std::string> targets) {
  const auto table = csv::Table::read(text, path);
  if (!table) return table.error();
  const auto columns = find_columns(*table, targets);
  if (!columns) return columns.error();
  std::vector<std::size_t> wanted = columns->weights;
  wanted.push_back(columns->time);
  const auto numbers = table->numbers(wanted);
  if (!numbers) return numbers.error();
  const std::vector<double>& times = numbers->back();
  if (Status status = check_times(*table, columns->time, times); !status) return status.error();

  WeightFile file;
  file.rate = rate_of(times);
  file.curves.names.assign(targets.begin(), targets.end());
  file.curves.curves.resize(targets.size());
  for (std::size_t i = 0; i < columns->targets.size(); ++i) {
    MorphCurve& curve = file.curves.curves[columns->targets[i]];
    const std::vector<double>& values = (*numbers)[i];
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (std::isnan(values[row])) continue;  // a gap: no key here
      if (!(std::abs(values[row]) <= kLargestWeight)) {
        return at(Error("weights-value",
                        fmt::format("the weight {} is out of range", readable(values[row]))),
                  table->place(row, columns->weights[i]));
      }
      curve.times.push_back(times[row]);
      curve.weights.push_back(values[row]);
    }
  }
  return file;
}

}  // namespace krok::weights
