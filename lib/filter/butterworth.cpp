#include "filter/butterworth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numbers.h"

namespace krok::filter {

namespace {

void run(const Section& s, std::span<double> series) {
  if (series.empty()) return;
  // Steady state of a constant input (direct form II transposed).
  double state2 = (s.b2 - s.a2) * series[0];
  double state1 = (s.b1 - s.a1) * series[0] + state2;
  for (double& value : series) {
    const double in = value;
    value = s.b0 * in + state1;
    state1 = s.b1 * in - s.a1 * value + state2;
    state2 = s.b2 * in - s.a2 * value;
  }
}

}  // namespace

Result<std::vector<Section>> design(const Butterworth& filter, double rate) {
  if (filter.order < 2 || filter.order > 8 || filter.order % 2 != 0) {
    return Error("filter-order", fmt::format("invalid Butterworth filter order {}", filter.order),
                 "the order of both passes together must be 2, 4, 6 or 8");
  }
  const int poles = filter.order / 2;
  if (!(filter.cutoff > 0) || !std::isfinite(filter.cutoff) || !(filter.cutoff < rate / 2)) {
    return Error("filter-cutoff",
                 fmt::format("a cutoff of {} Hz is not between 0 and {} Hz, half the frame rate",
                             readable(filter.cutoff), readable(rate / 2)),
                 "6 Hz to 12 Hz suit human motion");
  }
  // |H|^2 of one pass is 1 / (1 + (w / corner)^(2 poles)); two passes square it.
  const double correction = std::pow(std::numbers::sqrt2 - 1, -1.0 / (2 * poles));
  const double w = std::tan(std::numbers::pi * filter.cutoff / rate) * correction;
  std::vector<Section> sections;
  for (int pair = 0; pair < poles / 2; ++pair) {
    const double damping = 2 * std::cos(std::numbers::pi * (poles - 1 - 2 * pair) / (2.0 * poles));
    const double scale = 1 / (1 + damping * w + w * w);
    const double b = w * w * scale;
    sections.push_back({b, 2 * b, b, 2 * (w * w - 1) * scale, (1 - damping * w + w * w) * scale});
  }
  if (poles % 2 != 0) {
    const double scale = 1 / (1 + w);
    sections.push_back({w * scale, w * scale, 0, (w - 1) * scale, 0});
  }
  return sections;
}

void filter_both_ways(std::span<const Section> sections, int padding, std::span<double> series) {
  const auto size = static_cast<std::ptrdiff_t>(series.size());
  if (size < 2) return;
  const std::ptrdiff_t pad = std::clamp<std::ptrdiff_t>(padding, 0, size - 1);
  std::vector<double> longer(static_cast<std::size_t>(size + 2 * pad));
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(longer.size()); ++i) {
    const std::ptrdiff_t k = i - pad;
    const auto at = [&](std::ptrdiff_t place) { return series[static_cast<std::size_t>(place)]; };
    longer[static_cast<std::size_t>(i)] = k < 0       ? 2 * at(0) - at(-k)
                                          : k >= size ? 2 * at(size - 1) - at(2 * (size - 1) - k)
                                                      : at(k);
  }
  for (int pass = 0; pass < 2; ++pass) {
    for (const Section& section : sections) run(section, longer);
    std::ranges::reverse(longer);
  }
  std::copy_n(longer.begin() + pad, size, series.begin());
}

int padding_for(const Butterworth& filter, double rate) {
  return static_cast<int>(std::min(1e6, std::ceil(3 * rate / filter.cutoff)));
}

}  // namespace krok::filter
