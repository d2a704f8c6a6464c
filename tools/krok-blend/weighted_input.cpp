#include "tools/krok-blend/weighted_input.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/numbers.h"
#include "formats/csv/table.h"

namespace krok::cli::blend {

Result<WeightedInput> parse_weighted_input(const std::string& word) {
  const std::size_t colon = word.rfind(':');
  const auto wrong = [&](const std::string& what) {
    return Error("usage", what,
                 "give each motion a weight: walk.anim:0.5 or "
                 "walk.anim:@weights.csv");
  };
  WeightedInput input;
  if (colon == std::string::npos) {
    input.path = word;
    return input;
  }
  if (colon == 0) return wrong(fmt::format("'{}' names no motion", word));
  input.path = word.substr(0, colon);
  const std::string weight = word.substr(colon + 1);
  if (weight.size() > 1 && weight[0] == '@') {
    input.curve = weight.substr(1);
    return input;
  }
  input.weight = parse_finite(weight);
  if (!input.weight) return wrong(fmt::format("invalid weight '{}'", weight));
  return input;
}

Result<krok::blend::WeightCurve> read_weight_curve(const std::string& path, ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  const auto table = csv::Table::read(file->text(), path);
  if (!table) return table.error();
  std::array<std::size_t, 2> columns{};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    auto column = table->find(i == 0 ? "generic" : "weight");
    if (!column) {
      return std::move(column).error().in_file(path);
    }
    columns[i] = *column;
  }
  auto numbers = table->numbers(columns);
  if (!numbers) return numbers.error();
  krok::blend::WeightCurve curve{std::move((*numbers)[0]), std::move((*numbers)[1])};
  for (std::size_t row = 0; row < curve.generic.size(); ++row) {
    const bool sound = std::isfinite(curve.generic[row]) && std::isfinite(curve.weights[row]) &&
                       (row == 0 || curve.generic[row] > curve.generic[row - 1]);
    if (sound) continue;
    return Error("weight-curve",
                 fmt::format(
                     "row {} of the table is not after the previous one, or has a missing value",
                     row + 1),
                 "generic time must rise, and each row needs a weight")
        .in_file(path);
  }
  return curve;
}

}  // namespace krok::cli::blend
