#include "formats/bvh/choose_conventions_internal.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/numbers.h"

namespace krok::bvh {

namespace {

constexpr std::array kWholeRates = {24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0, 240.0};
constexpr std::array kNtscRates = {24.0 / 1.001, 30.0 / 1.001,  48.0 / 1.001,
                                   60.0 / 1.001, 120.0 / 1.001, 240.0 / 1.001};

// Relative change of the rate beyond which the printed digits are ambiguous.
constexpr double kFewDigits = 0.005;

// Plausible capture rates, from time lapse to high speed.
constexpr double kLowest = 4.0;
constexpr double kHighest = 1000.0;

// Place value of the last nonzero printed digit: 1e-7 for 0.0333333000.
double last_digit(std::string_view text) {
  int exponent = 0;
  const std::size_t mark = text.find_first_of("eE");
  if (mark != std::string_view::npos) {
    exponent = static_cast<int>(parse_integer(text.substr(mark + 1)).value_or(0));
    text = text.substr(0, mark);
  }
  const std::size_t point = text.find_first_of(".,");
  if (point == std::string_view::npos) return std::pow(10.0, exponent);
  while (text.back() == '0') text.remove_suffix(1);
  return std::pow(10.0, exponent - static_cast<int>(text.size() - point - 1));
}

// The likely unit of a frame time that gives an implausible rate; empty if unknown.
std::string meant_instead(double frame_time) {
  for (const double rate : kWholeRates) {
    if (std::abs(frame_time / rate - 1.0) < 0.01) return "frames per second";
    if (std::abs(frame_time * rate / 1000.0 - 1.0) < 0.03) return "milliseconds";
  }
  return {};
}

PrintedRate printed_rate(std::string_view text, double frame_time) {
  PrintedRate result;
  result.rate = 1.0 / frame_time;
  // Half a unit of the last digit, or a whole unit if digits were truncated instead of rounded.
  const double tolerance = last_digit(text) * (1.0 + 1e-9);
  const auto distance = [&](double rate) { return std::abs(1.0 / rate - frame_time); };
  const auto agrees = [&](double rate) {
    return distance(rate) <= 0.5 * tolerance ||
           (1.0 / rate > frame_time && distance(rate) < tolerance);
  };
  // Common rates also match a time stored in single precision: 1 / 30 is then 0.03333334.
  const auto agrees_in_single_precision = [&](double rate) {
    return agrees(rate) || distance(rate) <= 0.5 * tolerance + 0x1p-24 / rate;
  };
  const auto nearest = [&](const auto& rates) {
    double best = 0;
    for (const double rate : rates) {
      if (!agrees_in_single_precision(rate)) continue;
      if (best == 0 || distance(rate) < distance(best)) best = rate;
    }
    return best;
  };
  double best = nearest(kWholeRates);
  const double ntsc = nearest(kNtscRates);
  const bool also_ntsc = best != 0 && ntsc != 0;
  if (best == 0) best = ntsc;
  // Other rates are rounded as much as the digits allow: 15, 59.94, 23.976.
  for (const double step : {1.0, 0.01, 0.001}) {
    if (best != 0) break;
    const double round = std::round(result.rate / step) * step;
    if (round < step || round > 1000 || !agrees(round)) continue;
    if (!agrees(round + step) && (round < 1.5 * step || !agrees(round - step))) best = round;
  }
  if (best == 0) {
    result.reason = fmt::format("1 / {} s, the Frame Time", text);
    return result;
  }
  const double change = std::abs(best * frame_time - 1.0);
  // 0.004 is exactly 1 / 250; with its single digit it may also be 1 / 240.
  const double as_printed = std::round(result.rate);
  if (change > kFewDigits && std::abs(as_printed * frame_time - 1.0) < 1e-9) {
    result.rate = as_printed;
    result.few_digits = true;
    result.reason = fmt::format("1 / {} s exactly, though with so few digits it may be {}", text,
                                readable(best));
    return result;
  }
  result.snapped = change > 1e-12;
  result.few_digits = change > kFewDigits;
  result.rate = best;
  result.reason =
      result.snapped
          ? fmt::format("the Frame Time {} s is 1 / {} to the printed digits", text, readable(best))
          : fmt::format("1 / {} s, the Frame Time", text);
  result.also_ntsc = also_ntsc;
  if (also_ntsc) result.reason += fmt::format("; {} has the same digits", readable(ntsc));
  return result;
}

}  // namespace

PrintedRate rate_of_frame_time(std::string_view text, double frame_time) {
  PrintedRate result = printed_rate(text, frame_time);
  result.unusual = result.rate < kLowest || result.rate > kHighest;
  if (!result.unusual) return result;
  const std::string meant = meant_instead(frame_time);
  result.reason += meant.empty() ? ", an implausible capture rate"
                                 : fmt::format(", though {} looks like {}", text, meant);
  return result;
}

}  // namespace krok::bvh
