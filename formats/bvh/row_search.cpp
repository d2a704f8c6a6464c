#include <fmt/format.h>

#include <optional>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/bvh/motion_rows.h"
#include "formats/bvh/row_lines_internal.h"

namespace krok::bvh {

namespace {

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
        words_for_(text, hierarchy, file_name) {}

  Result<RowIndex> index() {
    lines_ = split_lines(text_, header_.end);
    // Before counting: numbers without a blank between them would be one value.
    for (std::size_t i = 0; i < lines_.size() && channels_ > 0; ++i) {
      const bool row = static_cast<long long>(i) < header_.frames && !lines_[i].text;
      if (row && lines_[i].glued) return words_for_.number_fault(lines_[i].begin);
    }
    Status status = channels_ == 0     ? index_nothing()
                    : one_row_a_line() ? index_rows_as_lines()
                                       : index_rows_over_lines();
    if (!status) return status.error();
    if (Status step = settle_faults(); !step) return step.error();
    if (Status step = compare_count(); !step) return step.error();
    return std::move(result_);
  }

 private:
  struct Fault {
    std::size_t row;  // index among all rows, including faulty ones
    Error error;
  };

  bool strict() const { return options_.strictness == Strictness::strict; }
  bool repair() const { return options_.strictness == Strictness::repair; }
  bool enough_rows() const {
    return static_cast<long long>(result_.begins.size()) >= header_.frames;
  }

  void tell(Severity severity, Error failure) {
    failure.severity = severity;
    diagnostics_.push_back(std::move(failure));
  }

  // If any line has exactly as many words as there are channels, each line is a row: a wrapped row
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
      if (begins_another(line)) return another_begins(i);
      // A line after all rows that is not a row is text; trailing numbers in a file with too few
      // rows are a truncated row.
      if (i > last_row && (enough_rows() || line.text)) return text_after(i);
      if (line.text && std::size_t{2} * line.words < channels_) {
        if (Status status = text_between(line); !status) return status;
        continue;
      }
      if (too_many_faults(line.words == channels_)) continue;
      Status status = add_fault(line.words == channels_ ? words_for_.number_fault(line.begin)
                                                        : words_for_.length_fault(line));
      if (!status) return status;
    }
    return {};
  }

  // A second file appended to the first, or a second motion.
  bool begins_another(const Line& line) const {
    const std::string_view word = word_at(text_, line.begin);
    return line.text && (same_word(word, "HIERARCHY") || same_word(word, "MOTION"));
  }

  Status another_begins(std::size_t line) {
    text_ended_early_ = true;
    Error another =
        words_for_.error_at(lines_[line].begin, "bvh-text-after",
                            fmt::format("a second {} begins here; the rest of the file is ignored",
                                        shown(word_at(text_, lines_[line].begin))));
    if (strict()) return another;
    another.hint = "split the file to read both";
    tell(Severity::warning, std::move(another));
    return {};
  }

  // A comment, or a misplaced header line.
  Status text_between(const Line& line) {
    std::size_t end = line.begin;
    while (end < text_.size() && !is_line_end(text_[end])) ++end;
    Error failure = words_for_.error_at(
        line.begin, "bvh-syntax",
        fmt::format("the line '{}' between the rows is ignored",
                    shown(trimmed(text_.substr(line.begin, end - line.begin)))));
    if (strict()) return failure;
    if (++texts_between_ <= kMaxTold) tell(Severity::warning, std::move(failure));
    return {};
  }

  // Lines per row if all rows have the same number of lines but the total of values is wrong;
  // nullopt if the total is right, or the number of lines does not fit the number of frames.
  std::optional<std::size_t> lines_of_a_row() const {
    std::size_t count = 0;
    std::size_t values = 0;
    for (; count < lines_.size() && !lines_[count].text; ++count) values += lines_[count].words;
    if (header_.frames < 2 || count < 2) return std::nullopt;
    const auto frames = static_cast<std::size_t>(header_.frames);
    if (count % frames != 0 || values == frames * channels_) return std::nullopt;
    return count / frames;
  }

  // Rows of `height` lines each. The location of a faulty row is its first line.
  Status index_rows_of_lines(std::size_t height) {
    std::size_t whole = 0;
    std::size_t first_words = 0;
    for (std::size_t i = 0; i + height <= lines_.size() && !lines_[i].text; i += height) {
      Line row = lines_[i];
      for (std::size_t k = 1; k < height; ++k) {
        row.words += lines_[i + k].words;
        row.numbers = row.numbers && lines_[i + k].numbers;
      }
      if (i == 0) first_words = row.words;
      if (row.words == channels_ && row.numbers) {
        ++whole;
        result_.begins.push_back(row.begin);
        continue;
      }
      if (too_many_faults(row.words == channels_)) continue;
      Error fault = row.words == channels_
                        ? words_for_.number_fault(row.begin)
                        : words_for_.error_at(row.begin, "bvh-channel-count",
                                              fmt::format("{}, expected {}",
                                                          counted(row.words, "value"), channels_));
      if (Status status = add_fault(std::move(fault)); !status) return status;
    }
    if (whole > 0) return {};
    Error none = words_for_.error_at(
        lines_.front().begin, "bvh-channel-count",
        fmt::format("the first row has {}, but the joints have {}, and no row matches",
                    counted(static_cast<long long>(first_words), "value"),
                    counted(static_cast<long long>(channels_), "channel")));
    const std::string_view word = word_at(text_, lines_.front().begin);
    none.hint = is_number(word) ? "the hierarchy does not match the rows; export the file again"
                                : RowFaults::hint_for(word);
    return none;
  }

  // Rows over several lines, or several rows on a line: counts values.
  Status index_rows_over_lines() {
    if (const auto height = lines_of_a_row()) return index_rows_of_lines(*height);
    std::size_t values = 0;
    bool row_is_whole = true;
    std::size_t row_begin = 0;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const Line& line = lines_[i];
      if (line.text && begins_another(line)) {
        if (Status status = another_begins(i); !status) return status;
        break;
      }
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
            Status status = add_fault(words_for_.number_fault_at(word, at, values % channels_));
            if (!status) return status;
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
      Error more = words_for_.error_at(
          row_begin, "bvh-channel-count",
          fmt::format("{} after the last frame", counted(static_cast<long long>(rest), "value")));
      if (strict()) return more;
      tell(Severity::warning, std::move(more));
      return {};
    }
    if (row_is_whole) return add_fault(words_for_.short_fault(row_begin, text_.size(), rest));
    return {};
  }

  // Marks the next row as faulty; an Error if the strictness does not allow it.
  Status add_fault(Error error) {
    const std::size_t row = result_.begins.size();
    error.frame = static_cast<std::int64_t>(row);
    if (strict() || (error.code == "bvh-number" && !repair())) {
      if (error.hint.empty()) {
        error.hint = fmt::format(
            "frame {} of {}; --repair interpolates it from its neighbours, or drops it at the ends",
            row, header_.frames);
      }
      return error;
    }
    result_.begins.push_back(RowIndex::kFaulty);
    faults_.push_back({row, std::move(error)});
    return {};
  }

  // Limits the messages for a file with many faults: beyond the limit a frame is only marked. An
  // invalid number must still be listed if it is an error.
  bool too_many_faults(bool number) {
    if (faults_.size() < kMaxListed || (number && !repair())) return false;
    ++unlisted_;
    result_.begins.push_back(RowIndex::kFaulty);
    return true;
  }

  Status text_after(std::size_t line) {
    Error note =
        words_for_.error_at(lines_[line].begin, "bvh-text-after",
                            fmt::format("{} line{} after the data {} ignored", lines_.size() - line,
                                        lines_.size() - line == 1 ? "" : "s",
                                        lines_.size() - line == 1 ? "is" : "are"));
    const bool like_text = lines_[line].text;
    if (strict() && !like_text) return note;
    tell(like_text ? Severity::note : Severity::warning, std::move(note));
    text_ended_early_ = true;
    return {};
  }

  // If the file has too few frames and no line end after its last value, that value may be
  // truncated.
  Status doubt_cut_value() {
    if (result_.begins.empty() || enough_rows() || is_space(text_.back())) return {};
    if (result_.begins.back() == RowIndex::kFaulty || text_ended_early_) return {};
    const std::size_t begin = result_.begins.back();
    result_.begins.pop_back();
    return add_fault(words_for_.error_at(
        begin, "bvh-cut", "the file ends in the last value of this frame, which may be truncated"));
  }

  Status settle_faults() {
    if (Status status = doubt_cut_value(); !status) return status;
    std::vector<std::size_t> kept;
    // Only rows between complete ones can be interpolated.
    std::size_t first = result_.begins.size();
    std::size_t last = 0;
    for (std::size_t i = 0; i < result_.begins.size(); ++i) {
      if (result_.begins[i] == RowIndex::kFaulty) continue;
      first = std::min(first, i);
      last = i;
    }
    if (first == result_.begins.size() && !faults_.empty()) {
      Error none = std::move(faults_.front().error);
      none.message += "; no row of the file is complete";
      if (repair()) none.hint = "there is no complete row to interpolate from";
      return none;
    }
    for (Fault& fault : faults_) {
      const bool can_fill = fault.row > first && fault.row < last;
      const bool fill = repair() && can_fill;
      const char* what = fill ? "was interpolated from its neighbours" : "was dropped";
      if (repair()) {
        result_.repairs.push_back(fmt::format("line {}: frame {} {}: {}", fault.error.where.line,
                                              fault.row, what, fault.error.message));
      }
      if (++reported_ > kMaxTold) continue;
      fault.error.message += fmt::format("; frame {} {}", fault.row, what);
      fault.error.hint.clear();
      if (!repair() && can_fill) {
        fault.error.message += ", later frames move up";
        fault.error.hint = "--repair interpolates the frame from its neighbours instead";
      }
      if (repair()) fault.error.code = "bvh-repair";
      tell(Severity::warning, std::move(fault.error));
    }
    if (reported_ > kMaxTold) {
      Error more(repair() ? "bvh-repair" : "bvh-channel-count",
                 fmt::format("{} more faulty frames", reported_ - kMaxTold + unlisted_));
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
      Error nothing = words_for_.error_at(
          header_.frames_offset, "bvh-frame-count",
          fmt::format("{} frames are declared, but no joint has channels", header_.frames));
      if (strict()) return nothing;
      tell(Severity::warning, std::move(nothing));
      return {};
    }
    if (static_cast<long long>(rows_found_) == header_.frames) return {};
    std::string found = fmt::format("the file has {}", rows_found_);
    if (rows_found_ != result_.begins.size()) {
      found += fmt::format(", of which {} are used", result_.begins.size());
    }
    Error differs = words_for_.error_at(
        header_.frames_offset, "bvh-frame-count",
        fmt::format("{} declared, {}", counted(header_.frames, "frame is", "frames are"), found));
    if (result_.begins.empty() && header_.frames > 0 && !repair()) {
      differs.message = fmt::format("{} declared, the file has none",
                                    counted(header_.frames, "frame is", "frames are"));
      differs.hint = "the file is truncated; --repair reads the skeleton only";
      return differs;
    }
    if (strict()) {
      differs.hint = "without --strict the existing frames are used";
      return differs;
    }
    differs.hint = "the existing frames are used";
    if (repair()) {
      result_.repairs.push_back(fmt::format("line {}: {} frames instead of the {} declared",
                                            differs.where.line, result_.begins.size(),
                                            header_.frames));
    }
    tell(Severity::warning, std::move(differs));
    return {};
  }

  static constexpr int kMaxTold = 20;
  static constexpr std::size_t kMaxListed = 1000;

  std::string_view text_;
  const MotionHeader& header_;
  const Hierarchy& hierarchy_;
  const std::size_t channels_;
  const std::string& file_name_;
  const ReadOptions& options_;
  Diagnostics& diagnostics_;
  RowFaults words_for_;
  std::vector<Line> lines_;
  std::vector<Fault> faults_;
  std::size_t rows_found_ = 0;
  int reported_ = 0;
  int texts_between_ = 0;
  int unlisted_ = 0;
  bool text_ended_early_ = false;  // the data is followed by something else
  RowIndex result_;
};

}  // namespace

Result<RowIndex> index_rows_with_care(std::string_view text, const MotionHeader& header,
                                      const Hierarchy& hierarchy, const std::string& file_name,
                                      const ReadOptions& options, Diagnostics& diagnostics) {
  return CarefulIndexer(text, header, hierarchy, file_name, options, diagnostics).index();
}

}  // namespace krok::bvh
