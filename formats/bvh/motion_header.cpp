#include <fmt/format.h>

#include <optional>

#include "core/numbers.h"
#include "formats/bvh/motion_rows.h"
#include "formats/bvh/names.h"
#include "formats/bvh/text_cursor.h"

namespace krok::bvh {

namespace {

constexpr const char* kRateHint = "say the rate with --fps N, frames a second";

// The word after a keyword and its colon, which may stand apart from both.
std::string_view value_after_colon(TextCursor& cursor) {
  cursor.skip_blanks();
  cursor.accept(":");
  cursor.skip_blanks();
  return cursor.word();
}

}  // namespace

Result<MotionHeader> parse_motion_header(std::string_view text, std::size_t begin,
                                         const std::string& file_name, const ReadOptions& options,
                                         Diagnostics& diagnostics) {
  MotionHeader header;
  TextCursor cursor(text, begin);
  bool has_frames = false;
  bool has_time = false;
  const auto error_at = [&](std::size_t offset, const char* code, std::string message,
                            std::string hint = {}) {
    Error error(code, std::move(message), std::move(hint));
    error.where = locate(text, offset, file_name);
    return error;
  };
  while (!has_frames || !has_time) {
    if (!has_frames && cursor.accept("Frames")) {
      const std::string_view word = value_after_colon(cursor);
      header.frames_offset = cursor.word_begin();
      const auto count = parse_integer(word);
      if (!count || *count < 0) {
        return error_at(header.frames_offset, "bvh-frame-count",
                        fmt::format("'{}' is not a number of frames", shown(word)),
                        "write the number of rows that follow, such as Frames: 120");
      }
      header.frames = *count;
      has_frames = true;
    } else if (!has_time && cursor.accept("Frame")) {
      cursor.skip_blanks();
      if (!cursor.accept("Time")) {
        return error_at(cursor.position(), "bvh-syntax", "'Frame Time:' is expected",
                        "write Frame Time: and the seconds from frame to frame, such as 0.0333333");
      }
      header.frame_time_text = value_after_colon(cursor);
      header.frame_time_offset = cursor.word_begin();
      const auto value = parse_finite(header.frame_time_text);
      header.frame_time = value.value_or(0);
      has_time = true;
      if (header.frame_time > 1e-6 && header.frame_time < 1e6) continue;
      Error wrong = error_at(header.frame_time_offset, "bvh-frame-time",
                             fmt::format("the Frame Time '{}' is not a positive number of seconds",
                                         shown(header.frame_time_text)),
                             kRateHint);
      if (!options.rate) return wrong;
      if (options.strictness == Strictness::strict) return wrong;
      wrong.severity = Severity::warning;
      wrong.hint.clear();
      header.frame_time = 0;
      diagnostics.push_back(std::move(wrong));
    } else {
      cursor.skip_space();
      const std::string_view next = cursor.peek();
      if (has_frames && !next.empty()) {
        Error missing = error_at(
            cursor.position(), "bvh-frame-time",
            fmt::format("the Frame Time is missing; '{}' stands in its place", shown(next)),
            kRateHint);
        if (!options.rate || options.strictness == Strictness::strict) return missing;
        missing.severity = Severity::warning;
        missing.hint.clear();
        diagnostics.push_back(std::move(missing));
        has_time = true;
        continue;
      }
      return error_at(cursor.position(), "bvh-syntax",
                      fmt::format("{} where '{}' is expected",
                                  next.empty() ? "the file ends" : fmt::format("'{}'", shown(next)),
                                  has_frames ? "Frame Time:" : "Frames:"),
                      next.empty() ? "the file is cut short; export or copy it again"
                                   : "write Frames: and the number of rows, such as Frames: 120");
    }
  }
  header.end = cursor.position();
  return header;
}

}  // namespace krok::bvh
