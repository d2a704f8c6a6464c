#include <fmt/format.h>

#include "core/numbers.h"
#include "formats/bvh/motion_rows.h"
#include "formats/bvh/names.h"
#include "formats/bvh/text_cursor.h"

namespace krok::bvh {

namespace {

// A line that is not empty.
struct Line {
  std::size_t begin = 0;    // its first word
  std::uint32_t words = 0;  // how many
  bool numbers = true;      // all of them whole, finite numbers
  bool text = false;        // the first one is not even the beginning of a number
};

// Letters at the start, but not those of nan and inf, show that a line is no row of numbers.
bool begins_like_text(std::string_view word) {
  const auto c = static_cast<unsigned char>(word.front());
  if ((c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+') return false;
  for (const std::string_view number : {"nan", "inf"}) {
    if (same_word(word.substr(0, 3), number)) return false;
  }
  return true;
}

// The word at `at` up to white space.
std::string_view word_at(std::string_view text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && !is_space(text[end])) ++end;
  return text.substr(at, end - at);
}

bool is_number(std::string_view word) {
  double value = 0;
  return parse_row(word, 0, {&value, 1}) == word.size();
}

std::vector<Line> split_lines(std::string_view text, std::size_t begin) {
  std::vector<Line> lines;
  std::size_t at = begin;
  while (at < text.size()) {
    Line line;
    while (at < text.size() && !is_line_end(text[at])) {
      if (is_space(text[at])) {
        ++at;
        continue;
      }
      const std::string_view word = word_at(text, at);
      if (line.words == 0) {
        line.begin = at;
        line.text = begins_like_text(word);
      }
      if (line.words < std::numeric_limits<std::uint32_t>::max()) ++line.words;
      line.numbers = line.numbers && is_number(word);
      at += word.size();
    }
    if (line.words > 0) lines.push_back(line);
    while (at < text.size() && is_line_end(text[at])) ++at;
  }
  return lines;
}

class CarefulIndexer {
 public:
  CarefulIndexer(std::string_view text, const MotionHeader& header, const Hierarchy& hierarchy,
                 const std::string& file_name, const ReadOptions& options, Diagnostics& diagnostics)
      : text_(text),
        header_(header),
        hierarchy_(hierarchy),
        channels_(hierarchy.channels.size()),
        file_name_(file_name),
        options_(options),
        diagnostics_(diagnostics),
        locate_(text, file_name) {}

  Result<RowIndex> index() {
    lines_ = split_lines(text_, header_.end);
    Status done = channels_ == 0     ? index_nothing()
                  : one_row_a_line() ? index_rows_as_lines()
                                     : index_rows_over_lines();
    if (!done) return done.error();
    if (Status settled = settle_faults(); !settled) return settled.error();
    if (Status counted = compare_count(); !counted) return counted.error();
    return std::move(result_);
  }

 private:
  struct Fault {
    std::size_t row;  // its place among the rows, faulty ones counted
    Error error;
  };

  bool strict() const { return options_.strictness == Strictness::strict; }
  bool repair() const { return options_.strictness == Strictness::repair; }
  bool enough_rows() const {
    return static_cast<long long>(result_.begins.size()) >= header_.frames;
  }

  Error error_at(std::size_t offset, std::string code, std::string message) {
    Error error(std::move(code), std::move(message));
    error.where = locate_(offset);
    return error;
  }

  void tell(Severity severity, Error told) {
    told.severity = severity;
    diagnostics_.push_back(std::move(told));
  }

  // Where a line has exactly as many words as there are channels, lines are rows. A wrapped row
  // never has such a line.
  bool one_row_a_line() const {
    for (const Line& line : lines_) {
      if (line.words == channels_) return true;
    }
    return false;
  }

  Status index_nothing() {
    if (lines_.empty()) return {};
    return text_after(0);
  }

  Status index_rows_as_lines() {
    std::size_t last_row = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (lines_[i].words == channels_ && !lines_[i].text) last_row = i;
    }
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const Line& line = lines_[i];
      if (line.words == channels_ && line.numbers) {
        result_.begins.push_back(line.begin);
        continue;
      }
      // What follows all rows and is none is text; a tail of numbers in a file that has too few
      // rows is a row cut short.
      if (i > last_row && (enough_rows() || line.text)) return text_after(i);
      if (too_many_faults(line.words == channels_)) continue;
      Status kept =
          add_fault(line.words == channels_ ? number_fault(line.begin) : length_fault(line));
      if (!kept) return kept;
    }
    return {};
  }

  // Rows that go over several lines, or several rows on a line: values are counted.
  Status index_rows_over_lines() {
    std::size_t values = 0;
    bool row_is_whole = true;
    std::size_t row_begin = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const Line& line = lines_[i];
      if (line.text && values % channels_ == 0) return text_after(i);
      std::size_t at = line.begin;
      for (std::uint32_t k = 0; k < line.words; ++k) {
        const std::string_view word = word_at(text_, at);
        if (values % channels_ == 0) {
          row_begin = at;
          row_is_whole = true;
        }
        if (row_is_whole && !line.numbers && !is_number(word)) {
          row_is_whole = false;
          if (!too_many_faults(true)) {
            Status kept = add_fault(number_fault_at(word, at, values % channels_));
            if (!kept) return kept;
          }
        }
        if (++values % channels_ == 0 && row_is_whole) result_.begins.push_back(row_begin);
        at += word.size();
        while (at < text_.size() && is_space(text_[at])) ++at;
      }
    }
    const std::size_t rest = values % channels_;
    if (rest == 0) return {};
    if (values / channels_ >= static_cast<std::size_t>(header_.frames)) {
      Error more = error_at(row_begin, "bvh-channel-count",
                            fmt::format("{} values after the last frame", rest));
      if (strict()) return more;
      tell(Severity::warning, std::move(more));
      return {};
    }
    if (row_is_whole) return add_fault(short_fault(row_begin, text_.size(), rest));
    return {};
  }

  Error number_fault(std::size_t begin) {
    std::size_t at = begin;
    for (std::size_t channel = 0; channel < channels_; ++channel) {
      const std::string_view word = word_at(text_, at);
      if (!is_number(word)) return number_fault_at(word, at, channel);
      at += word.size();
      while (at < text_.size() && is_space(text_[at])) ++at;
    }
    return error_at(begin, "bvh-number", "a value is not a number");
  }

  Error number_fault_at(std::string_view word, std::size_t at, std::size_t channel) {
    Error error = error_at(at, "bvh-number",
                           fmt::format("'{}' is {} ({})", shown(word),
                                       parse_finite(word) ? "too large" : "not a finite number",
                                       hierarchy_.channel_name(channel)));
    error.hint = word.find(',') != std::string_view::npos
                     ? "numbers are written with a decimal point"
                     : "--repair fills the frame from its neighbours";
    error.joint =
        hierarchy_.joints[static_cast<std::size_t>(hierarchy_.channels[channel].joint)].name;
    return error;
  }

  Error length_fault(const Line& line) {
    if (line.words < channels_) {
      std::size_t end = line.begin;
      while (end < text_.size() && !is_line_end(text_[end])) ++end;
      return short_fault(line.begin, end, line.words);
    }
    std::size_t at = line.begin;
    for (std::size_t i = 0; i < channels_; ++i) {
      at += word_at(text_, at).size();
      while (at < text_.size() && is_space(text_[at])) ++at;
    }
    return error_at(at, "bvh-channel-count",
                    fmt::format("{} values, expected {}", line.words, channels_));
  }

  // `begin` .. `end` holds `values` values, too few; the place told is where the next should stand.
  Error short_fault(std::size_t begin, std::size_t end, std::size_t values) {
    while (end > begin && is_space(text_[end - 1])) --end;
    const std::size_t missing = channels_ - values;
    return error_at(end, "bvh-channel-count",
                    fmt::format("{} values, expected {} (missing: {}{})", values, channels_,
                                hierarchy_.channel_name(values),
                                missing == 1 ? "" : fmt::format(" and {} more", missing - 1)));
  }

  // Marks the next row as faulty; an Error where the strictness does not allow it.
  Status add_fault(Error error) {
    const std::size_t row = result_.begins.size();
    error.frame = static_cast<std::int64_t>(row);
    if (strict() || (error.code == "bvh-number" && !repair())) {
      if (error.hint.empty()) {
        error.hint = fmt::format(
            "frame {} of {}; --repair fills it from its neighbours, or drops "
            "it at the ends",
            row, header_.frames);
      }
      return error;
    }
    result_.begins.push_back(RowIndex::kFaulty);
    faults_.push_back({row, std::move(error)});
    return {};
  }

  // Keeps a file of faults alone from making more messages than text: beyond a number only the
  // frame is marked. A number that is none must be listed where it is an error.
  bool too_many_faults(bool number) {
    if (faults_.size() < kMostListed || (number && !repair())) return false;
    ++unlisted_;
    result_.begins.push_back(RowIndex::kFaulty);
    return true;
  }

  Status text_after(std::size_t line) {
    Error note = error_at(lines_[line].begin, "bvh-text-after",
                          fmt::format("{} line{} after the data {} left out", lines_.size() - line,
                                      lines_.size() - line == 1 ? "" : "s",
                                      lines_.size() - line == 1 ? "is" : "are"));
    const bool like_text = lines_[line].text;
    if (strict() && !like_text) return note;
    tell(like_text ? Severity::note : Severity::warning, std::move(note));
    text_ended_early_ = true;
    return {};
  }

  // A file that ends without a line end, in its last frame's last value, with frames missing: the
  // value may have more digits than are left of it.
  Status doubt_cut_value() {
    if (result_.begins.empty() || enough_rows() || is_space(text_.back())) return {};
    if (result_.begins.back() == RowIndex::kFaulty || text_ended_early_) return {};
    const std::size_t begin = result_.begins.back();
    result_.begins.pop_back();
    return add_fault(error_at(
        begin, "bvh-cut", "the file ends in the last value of this frame, which may be cut short"));
  }

  Status settle_faults() {
    if (Status doubted = doubt_cut_value(); !doubted) return doubted;
    std::vector<std::size_t> kept;
    // Only rows between whole ones can be filled.
    std::size_t first = result_.begins.size();
    std::size_t last = 0;
    for (std::size_t i = 0; i < result_.begins.size(); ++i) {
      if (result_.begins[i] == RowIndex::kFaulty) continue;
      first = std::min(first, i);
      last = i;
    }
    for (Fault& fault : faults_) {
      const bool can_fill = fault.row > first && fault.row < last;
      const bool fill = repair() && can_fill;
      const char* what = fill ? "was filled from its neighbours" : "was left out";
      if (repair()) {
        result_.repairs.push_back(fmt::format("line {}: frame {} {}: {}", fault.error.where.line,
                                              fault.row, what, fault.error.message));
      }
      if (++told_ > kMostTold) continue;
      fault.error.message += fmt::format("; frame {} {}", fault.row, what);
      fault.error.hint.clear();
      if (!repair() && can_fill) {
        fault.error.message += ", so that later frames come earlier";
        fault.error.hint = "--repair fills the frame from its neighbours instead";
      }
      if (repair()) fault.error.code = "bvh-repair";
      tell(Severity::warning, std::move(fault.error));
    }
    if (told_ > kMostTold) {
      Error more(repair() ? "bvh-repair" : "bvh-channel-count",
                 fmt::format("{} more faulty frames", told_ - kMostTold + unlisted_));
      if (repair() && unlisted_ > 0) result_.repairs.push_back(more.message);
      tell(Severity::warning, std::move(more).in_file(file_name_));
    }
    for (std::size_t i = 0; i < result_.begins.size(); ++i) {
      const bool filled = repair() && i > first && i < last;
      if (result_.begins[i] != RowIndex::kFaulty || filled) kept.push_back(result_.begins[i]);
    }
    rows_found_ = result_.begins.size();
    result_.begins = std::move(kept);
    return {};
  }

  Status compare_count() {
    if (channels_ == 0 && header_.frames > 0) {
      Error nothing = error_at(
          header_.frames_offset, "bvh-frame-count",
          fmt::format("{} frames are announced, but no joint has channels", header_.frames));
      if (strict()) return nothing;
      tell(Severity::warning, std::move(nothing));
      return {};
    }
    if (static_cast<long long>(rows_found_) == header_.frames) return {};
    Error differs = error_at(header_.frames_offset, "bvh-frame-count",
                             fmt::format("{} frames are announced, the file has {}", header_.frames,
                                         result_.begins.size()));
    if (result_.begins.empty() && header_.frames > 0 && !repair()) {
      differs.message = fmt::format("{} frames are announced, the file has none", header_.frames);
      differs.hint = "the file is cut short; --repair takes the skeleton alone";
      return differs;
    }
    if (strict()) {
      differs.hint = "without --strict the frames that are there are taken";
      return differs;
    }
    differs.hint = "the frames that are there were taken";
    if (repair()) {
      result_.repairs.push_back(fmt::format("line {}: {} frames instead of the {} announced",
                                            differs.where.line, result_.begins.size(),
                                            header_.frames));
    }
    tell(Severity::warning, std::move(differs));
    return {};
  }

  static constexpr int kMostTold = 20;
  static constexpr std::size_t kMostListed = 1000;

  std::string_view text_;
  const MotionHeader& header_;
  const Hierarchy& hierarchy_;
  const std::size_t channels_;
  const std::string& file_name_;
  const ReadOptions& options_;
  Diagnostics& diagnostics_;
  Locator locate_;
  std::vector<Line> lines_;
  std::vector<Fault> faults_;
  std::size_t rows_found_ = 0;
  int told_ = 0;
  int unlisted_ = 0;
  bool text_ended_early_ = false;  // something that is no data follows the data
  RowIndex result_;
};

}  // namespace

Result<RowIndex> index_rows_with_care(std::string_view text, const MotionHeader& header,
                                      const Hierarchy& hierarchy, const std::string& file_name,
                                      const ReadOptions& options, Diagnostics& diagnostics) {
  return CarefulIndexer(text, header, hierarchy, file_name, options, diagnostics).index();
}

}  // namespace krok::bvh
