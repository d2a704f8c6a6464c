#include "formats/textgrid/textgrid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/table.h"

namespace krok::textgrid {

namespace {

constexpr double kLatest = 1e6;  // seconds, of either sign

// As UTF-8, by the byte-order mark.
std::string as_utf8(std::string_view bytes) {
  const bool little = bytes.starts_with("\xFF\xFE"), big = bytes.starts_with("\xFE\xFF");
  if (!little && !big) return to_utf8(without_byte_order_mark(bytes));
  const auto unit_at = [&](std::size_t i) {
    const auto a = static_cast<unsigned char>(bytes[i]);
    const auto b = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<char32_t>(little ? a | b << 8 : a << 8 | b);
  };
  std::string text;
  for (std::size_t i = 2; i + 1 < bytes.size(); i += 2) {
    char32_t unit = unit_at(i);
    const bool high = unit >= 0xD800 && unit < 0xDC00;
    if (high && i + 3 < bytes.size()) {
      const char32_t low = unit_at(i + 2);
      if (low >= 0xDC00 && low < 0xE000) {
        unit = 0x10000 + ((unit - 0xD800) << 10) + (low - 0xDC00);
        i += 2;
      }
    }
    append_utf8(unit, text);
  }
  return text;
}

// What Praat reads of a text file: numbers that stand by themselves, texts in double quotes, and
// flags in angle brackets. All else is for people: "xmin =", "intervals [1]:", comments after "!".
class Reader {
 public:
  Reader(std::string_view text, const std::string& path) : text_(text), locate_(text, path) {}

  Result<TextGrid> read() {
    auto type = text("the file type");
    if (!type) return type.error();
    if (!type->label.starts_with("ooTextFile")) {
      return error(type->where, "kind", fmt::format("is a '{}'", shown(type->label)),
                   "save it from Praat with \"Save as text file...\"");
    }
    auto kind = text("the object class");
    if (!kind) return kind.error();
    if (kind->label != "TextGrid") {
      return error(kind->where, "kind", fmt::format("holds a {}, no TextGrid", shown(kind->label)));
    }
    TextGrid grid;
    if (Status status = times(grid.start, grid.end); !status) return status.error();
    const auto flag = next('<', "<exists>");
    if (!flag) return flag.error();
    if (*flag != "<exists>") return grid;
    const auto count = number("the number of tiers");
    if (!count) return count.error();
    for (double t = 0; t < *count; ++t) {
      if (Status status = read_tier(grid.tiers.emplace_back()); !status) return status.error();
    }
    return grid;
  }

 private:
  Error error(const Location& where, const char* kind, std::string message,
              std::string hint = {}) const {
    Error made(fmt::format("textgrid-{}", kind), std::move(message), std::move(hint));
    made.where = where;
    return made;
  }

  // The next value, which must begin with `kind`: '"', '<' or '0'. Leaves at_ behind it, and
  // begin_ at it.
  Result<std::string_view> next(char kind, std::string_view what) {
    for (;;) {
      while (at_ < text_.size() && is_space(text_[at_])) ++at_;
      begin_ = at_;
      if (at_ == text_.size()) {
        return error(locate_(begin_), "structure", fmt::format("the file ends before {}", what));
      }
      const char c = text_[at_];
      char found = 0;
      if (c == '!') {
        while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
        continue;
      }
      if (c == '"') {
        if (!skip_text()) {
          return error(locate_(begin_), "structure", "a text without a closing quote");
        }
        found = c;
      } else {
        while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
        const std::string_view word = text_.substr(begin_, at_ - begin_);
        if (c == '<' && word.ends_with('>')) found = c;
        if (parse_finite(word)) found = '0';
        if (found == 0) continue;
      }
      if (found == kind) return text_.substr(begin_, at_ - begin_);
      return error(locate_(begin_), "structure",
                   fmt::format("'{}' where {} is expected",
                               shown(text_.substr(begin_, at_ - begin_)), what));
    }
  }

  // A quote within is written twice.
  bool skip_text() {
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] != '"') continue;
      ++at_;
      if (at_ == text_.size() || text_[at_] != '"') return true;
    }
    return false;
  }

  Result<double> number(std::string_view what) {
    const auto word = next('0', what);
    if (!word) return word.error();
    const double value = *parse_finite(*word);
    if (std::abs(value) <= kLatest) return value;
    return error(locate_(begin_), "value", fmt::format("{} is {}", what, readable(value)));
  }

  // A text and where it is.
  Result<Interval> text(std::string_view what) {
    const auto word = next('"', what);
    if (!word) return word.error();
    Interval made;
    made.where = locate_(begin_);
    const std::string_view inner = word->substr(1, word->size() - 2);
    for (std::size_t i = 0; i < inner.size(); ++i) {
      made.label += inner[i];
      if (inner[i] == '"') ++i;
    }
    return made;
  }

  Status times(double& start, double& end) {
    const auto from = number("a start time");
    if (!from) return from.error();
    const auto to = number("an end time");
    if (!to) return to.error();
    start = *from;
    end = *to;
    if (end >= start) return {};
    return error(
        locate_(begin_), "time",
        fmt::format("{} s is before the start at {} s", readable(end, 9), readable(start, 9)));
  }

  Status read_tier(Tier& tier) {
    const auto kind = text("the class of a tier");
    if (!kind) return kind.error();
    if (kind->label != "IntervalTier" && kind->label != "TextTier") {
      return error(kind->where, "structure",
                   fmt::format("a tier of the class '{}'", shown(kind->label)),
                   "it is IntervalTier or TextTier");
    }
    tier.points = kind->label == "TextTier";
    auto name = text("the name of a tier");
    if (!name) return name.error();
    tier.name = std::move(name->label);
    double start = 0, end = 0;
    if (Status status = times(start, end); !status) return status;
    const auto count = number("the number of intervals");
    if (!count) return count.error();
    double before = -kLatest;
    for (double i = 0; i < *count; ++i) {
      if (Status status = read_interval(tier, before); !status) return status;
    }
    return {};
  }

  Status read_interval(Tier& tier, double& before) {
    double start = 0, end = 0;
    if (tier.points) {
      const auto time = number("a time");
      if (!time) return time.error();
      start = end = *time;
    } else if (Status status = times(start, end); !status) {
      return status;
    }
    if (start < before) {
      return error(locate_(begin_), "time",
                   fmt::format("{} s is before the one before ends at {} s", readable(start, 9),
                               readable(before, 9)));
    }
    before = end;
    auto label = text("a label");
    if (!label) return label.error();
    if (!tier.points && start == end) return {};
    tier.intervals.push_back({start, end, std::move(label->label), std::move(label->where)});
    return {};
  }

  std::string_view text_;
  Locator locate_;
  std::size_t at_ = 0, begin_ = 0;
};

Result<std::vector<Interval>> read_table(std::string_view text, const std::string& path) {
  const auto table = csv::Table::read(text, path);
  if (!table) return table.error();
  std::vector<std::size_t> columns;
  for (const char* name : {"start", "end", "label"}) {
    const auto column = table->find(name);
    if (!column) return column.error();
    columns.push_back(*column);
  }
  const auto times = table->numbers(std::span(columns).first(2));
  if (!times) return times.error();
  const std::vector<std::string> labels = table->texts(columns[2]);
  std::vector<Interval> intervals;
  double before = -kLatest;
  for (std::size_t row = 0; row < labels.size(); ++row) {
    const double start = (*times)[0][row], end = (*times)[1][row];
    if (!(start >= before && end > start && end <= kLatest)) {
      Error error("textgrid-time",
                  fmt::format("from {} to {} s: times must increase, without overlap",
                              readable(start, 9), readable(end, 9)));
      error.where = table->place(row, columns[0]);
      return error;
    }
    before = end;
    intervals.push_back({start, end, labels[row], table->place(row, columns[2])});
  }
  return intervals;
}

}  // namespace

Result<TextGrid> read(std::string_view bytes, const std::string& path) {
  if (bytes.starts_with("ooBinaryFile")) {
    return Error("textgrid-kind", "is a binary file of Praat",
                 "save it from Praat with \"Save as text file...\"")
        .in_file(path);
  }
  const std::string text = as_utf8(bytes);
  return Reader(text, path).read();
}

Result<std::vector<Interval>> read_intervals(std::string_view bytes, const std::string& path,
                                             const std::string& tier) {
  const std::string text = as_utf8(bytes);
  const std::string_view first = trimmed(std::string_view(text).substr(0, 200));
  const bool is_grid = first.starts_with("File type") || first.starts_with("\"ooTextFile") ||
                       first.starts_with("\"Praat") || bytes.starts_with("ooBinaryFile");
  if (!is_grid) return read_table(text, path);
  auto grid = read(bytes, path);
  if (!grid) return grid.error();
  std::vector<std::string> names;
  Tier *found = nullptr, *only = nullptr;
  for (Tier& one : grid->tiers) {
    if (one.points) continue;
    names.push_back(one.name);
    only = names.size() == 1 ? &one : nullptr;
    const std::string name = ascii_lower(one.name);
    const bool usual = tier.empty() && (name == "phones" || name == "phonemes");
    if (found == nullptr && (usual || (!tier.empty() && one.name == tier))) found = &one;
  }
  if (found == nullptr && tier.empty()) found = only;
  if (found != nullptr) return std::move(found->intervals);
  return Error("textgrid-tier",
               tier.empty() ? std::string("has no tier \"phones\"")
                            : fmt::format("has no interval tier '{}'", shown(tier)),
               names.empty() ? std::string("it has no interval tiers")
                             : fmt::format("its interval tiers are {}", fmt::join(names, ", ")))
      .in_file(path);
}

}  // namespace krok::textgrid
