#include "formats/bvh/unit_mark.h"

#include <array>
#include <cmath>

namespace krok::bvh {

namespace {

constexpr std::array kMarkedUnits = {"m", "dm", "cm", "mm", "in", "ft", "cmu"};

std::string mark_of(std::size_t unit) {
  std::string mark = "\t ";
  for (const std::size_t bit : {4U, 2U, 1U}) mark += (unit & bit) != 0 ? '\t' : ' ';
  return mark + '\t';
}

}  // namespace

std::string unit_mark(double metres) {
  for (std::size_t u = 0; u < kMarkedUnits.size(); ++u) {
    if (std::abs(parse_unit(kMarkedUnits[u])->metres / metres - 1) < 1e-9) return mark_of(u);
  }
  return {};
}

std::optional<Unit> marked_unit(std::string_view rest) {
  if (rest.ends_with('\r')) rest.remove_suffix(1);
  for (std::size_t u = 0; u < kMarkedUnits.size(); ++u) {
    if (rest == mark_of(u)) return *parse_unit(kMarkedUnits[u]);
  }
  return std::nullopt;
}

}  // namespace krok::bvh
