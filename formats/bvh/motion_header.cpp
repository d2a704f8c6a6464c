#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "core/numbers.h"
#include "formats/bvh/choose_conventions_internal.h"
#include "formats/bvh/hierarchy.h"
#include "formats/bvh/motion_rows.h"
#include "formats/bvh/text_cursor.h"
#include "scene/clip.h"

namespace krok::bvh {

namespace {

constexpr const char* kRateHint = "set the rate with --fps N (frames per second)";
constexpr const char* kFramesHint =
    "write the number of rows, such as Frames: 120; --repair counts them";

// True if the word begins with a letter, which a row of values never does; nan and inf count as
// values.
bool is_word(std::string_view word) {
  if (word.empty() || (ascii_lower(word.front()) < 'a' || ascii_lower(word.front()) > 'z')) {
    return false;
  }
  return !same_word(word.substr(0, 3), "nan") && !same_word(word.substr(0, 3), "inf");
}

class HeaderParser {
 public:
  HeaderParser(std::string_view text, std::size_t begin, const std::string& file_name,
               const ReadOptions& options, Diagnostics& diagnostics)
      : text_(text),
        file_name_(file_name),
        options_(options),
        diagnostics_(diagnostics),
        cursor_(text, begin) {}

  Result<MotionHeader> parse() {
    while (!has_frames_ || !has_time_) {
      Status status;
      if (!has_frames_ && cursor_.accept("Frames")) {
        status = parse_frames();
      } else if (!has_time_ && cursor_.accept("Frame")) {
        status = parse_frame_time();
      } else {
        status = something_else();
      }
      if (!status) return status.error();
    }
    if (Status status = skip_other_lines(); !status) return status.error();
    header_.end = cursor_.position();
    if (count_rows_) count_rows();
    return header_;
  }

 private:
  Error error_at(std::size_t offset, const char* code, std::string message, std::string hint = {}) {
    Error error(code, std::move(message), std::move(hint));
    error.where = locate(text_, offset, file_name_);
    return error;
  }

  // A fault that is an error only if strict.
  Status warn(Error failure) {
    if (options_.strictness == Strictness::strict) return failure;
    failure.severity = Severity::warning;
    failure.hint.clear();
    diagnostics_.push_back(std::move(failure));
    return {};
  }

  // The word after a keyword and its colon, with optional blanks around the colon; empty at the end
  // of the line.
  std::string_view value_after_colon() {
    cursor_.skip_blanks();
    if (cursor_.on_line(":")) cursor_.accept(":");
    cursor_.skip_blanks();
    return cursor_.word_on_line();
  }

  // Skips words after a value, such as its unit; the other keyword may also follow on the line.
  Status skip_rest(const char* after) {
    cursor_.skip_blanks();
    const TextCursor before = cursor_;
    const std::string_view first = cursor_.word_on_line();
    cursor_ = before;
    const bool keyword = same_word(first.substr(0, 5), "Frame");
    if (first.empty() || keyword || parse_finite(first)) return {};
    const std::size_t place = cursor_.position();
    const std::string_view rest = cursor_.line();
    return warn(error_at(place, "bvh-syntax",
                         fmt::format("'{}' after the {} is ignored", shown(rest), after)));
  }

  Status parse_frames() {
    const std::string_view word = value_after_colon();
    header_.frames_offset = cursor_.word_begin();
    has_frames_ = true;
    const auto count = parse_integer(word);
    if (count && *count >= 0) {
      header_.frames = *count;
      return skip_rest("number of frames");
    }
    // "120.0", "1.2e2"
    const auto number = parse_finite(word);
    if (number && *number >= 0 && *number < 1e9 && *number == std::floor(*number)) {
      header_.frames = static_cast<long long>(*number);
      Status status =
          warn(error_at(header_.frames_offset, "bvh-frame-count",
                        fmt::format("the number of frames is written as '{}', read as {}",
                                    shown(word), header_.frames)));
      return status ? skip_rest("number of frames") : status;
    }
    Error wrong =
        error_at(header_.frames_offset, "bvh-frame-count",
                 word.empty() ? "the number of frames is missing"
                              : fmt::format("'{}' is not a number of frames", shown(word)),
                 kFramesHint);
    if (options_.strictness != Strictness::repair) return wrong;
    count_rows_ = true;
    cursor_.line();
    return warn(std::move(wrong));
  }

  Status parse_frame_time() {
    cursor_.skip_blanks();
    if (!cursor_.accept("Time")) {
      return error_at(cursor_.position(), "bvh-syntax", "'Frame Time:' is expected",
                      "write Frame Time: and the seconds per frame, such as 0.0333333");
    }
    header_.frame_time_text = value_after_colon();
    header_.frame_time_offset = cursor_.word_begin();
    has_time_ = true;
    if (Status status = read_frame_time(); !status) return status;
    const double rate = 1 / header_.frame_time;
    if (rate >= kMinRate && rate <= kMaxRate) return skip_rest("Frame Time");
    header_.frame_time = 0;
    Error wrong = error_at(header_.frame_time_offset, "bvh-frame-time",
                           header_.frame_time_text.empty()
                               ? "the Frame Time has no value"
                               : fmt::format("the Frame Time '{}' is not 0.00001 to 1000 seconds",
                                             shown(header_.frame_time_text)),
                           kRateHint);
    if (!options_.rate) return wrong;
    if (Status status = warn(std::move(wrong)); !status) return status;
    return skip_rest("Frame Time");
  }

  // A single comma in a number without a point is a decimal comma.
  Status read_frame_time() {
    const std::string_view word = header_.frame_time_text;
    if (const auto value = parse_finite(word)) {
      header_.frame_time = *value;
      return {};
    }
    const std::size_t comma = word.find(',');
    if (comma == std::string_view::npos || word.find('.') != std::string_view::npos) return {};
    std::string with_point(word);
    with_point[comma] = '.';
    const auto value = parse_finite(with_point);
    if (!value) return {};
    header_.frame_time = *value;
    return warn(error_at(header_.frame_time_offset, "bvh-frame-time",
                         fmt::format("the Frame Time '{}' has a decimal comma, read as {}",
                                     shown(word), with_point)));
  }

  // Neither keyword where one of them is expected.
  Status something_else() {
    cursor_.skip_space();
    const std::string_view next = cursor_.peek();
    if (has_frames_ && !next.empty()) {
      has_time_ = true;
      Error missing = error_at(
          cursor_.position(), "bvh-frame-time",
          fmt::format("the Frame Time is missing; found '{}' instead", shown(next)), kRateHint);
      if (!options_.rate) return missing;
      return warn(std::move(missing));
    }
    return error_at(cursor_.position(), "bvh-syntax",
                    fmt::format("{} where '{}' is expected",
                                next.empty() ? "the file ends" : fmt::format("'{}'", shown(next)),
                                has_frames_ ? "Frame Time:" : "Frames:"),
                    next.empty() ? "the file is truncated; export or copy it again"
                                 : "write Frames: and the number of rows, such as Frames: 120");
  }

  // "Frame Rate: 30" and the like, before the first row.
  Status skip_other_lines() {
    if (header_.frames == 0 && !count_rows_) return {};
    for (;;) {
      const TextCursor before = cursor_;
      cursor_.skip_space();
      const std::size_t place = cursor_.position();
      if (!is_word(cursor_.peek())) {
        cursor_ = before;
        return {};
      }
      if (++lines_left_out_ > kMaxTold && options_.strictness != Strictness::strict) {
        cursor_.line();
        continue;
      }
      Status status = warn(error_at(
          place, "bvh-syntax", fmt::format("unknown line '{}' is ignored", shown(cursor_.line()))));
      if (!status) return status;
    }
  }

  void count_rows() {
    header_.frames = static_cast<long long>(index_lines(text_, header_.end).size());
  }

  std::string_view text_;
  const std::string& file_name_;
  const ReadOptions& options_;
  Diagnostics& diagnostics_;
  TextCursor cursor_;
  MotionHeader header_;
  bool has_frames_ = false;
  bool has_time_ = false;
  // Limits the number of messages, and the time to find their line numbers.
  static constexpr int kMaxTold = 20;
  int lines_left_out_ = 0;
  bool count_rows_ = false;  // the value of Frames: is not a number
};

constexpr std::array kMarkedUnits = {"m", "dm", "cm", "mm", "in", "ft", "cmu"};

std::string mark_of(std::size_t unit) {
  std::string mark = "\t ";
  for (const std::size_t bit : {4U, 2U, 1U}) mark += (unit & bit) != 0 ? '\t' : ' ';
  return mark + '\t';
}

}  // namespace

Result<MotionHeader> parse_motion_header(std::string_view text, std::size_t begin,
                                         const std::string& file_name, const ReadOptions& options,
                                         Diagnostics& diagnostics) {
  return HeaderParser(text, begin, file_name, options, diagnostics).parse();
}

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
