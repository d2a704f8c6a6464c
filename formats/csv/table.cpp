#include "formats/csv/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/csv_writer.h"

namespace krok::csv {

namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

bool is_gap(std::string_view text) {
  constexpr std::array kGaps = {"nan", "+nan", "-nan", "na",       "n/a",      "null",
                                "inf", "+inf", "-inf", "infinity", "-infinity"};
  if (text.empty()) return true;
  if (text.size() > 9) return false;
  return std::any_of(kGaps.begin(), kGaps.end(),
                     [&](const char* gap) { return same_word(text, gap); });
}

// A number, or a gap; nullopt for other text. Between semicolons a comma is a decimal point.
std::optional<double> parse_cell(std::string_view text, char delimiter) {
  text = trimmed(text);
  if (const auto value = parse_finite(text)) return value;
  if (const std::size_t comma = text.find(','); delimiter == ';' && comma != text.npos) {
    const std::string whole(text.substr(0, comma));
    if (const auto value = parse_finite(whole + "." + std::string(text.substr(comma + 1))))
      return value;
  }
  if (is_gap(text)) return kGap;
  return std::nullopt;
}

// The most frequent of comma, semicolon and tab in the line at `at`; comma if there is none.
char delimiter_of(std::string_view text, std::size_t at) {
  std::array<std::size_t, 3> counts = {};
  constexpr std::array kDelimiters = {',', ';', '\t'};
  bool quoted = false;
  for (; at < text.size() && (quoted || !is_line_end(text[at])); ++at) {
    if (text[at] == '"') quoted = !quoted;
    for (std::size_t d = 0; d < kDelimiters.size() && !quoted; ++d) {
      counts[d] += text[at] == kDelimiters[d] ? 1 : 0;
    }
  }
  return kDelimiters[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) -
                                              counts.begin())];
}

std::size_t behind_line_end(std::string_view text, std::size_t at) {
  if (at < text.size() && text[at] == '\r') ++at;
  return at < text.size() && text[at] == '\n' ? at + 1 : at;
}

}  // namespace

Location Table::place_of(std::size_t offset) const {
  return locate(text_, offset, path_);
}

Result<Table::Cell> Table::cell_at(std::size_t at) const {
  Cell cell;
  const auto ends = [&](std::size_t i) {
    return i >= text_.size() || text_[i] == delimiter_ || is_line_end(text_[i]);
  };
  const auto fault = [&](std::size_t where, const char* message) {
    Error error("csv-quote", message, "double a quote inside a quoted cell");
    error.where = place_of(where);
    return error;
  };
  std::size_t end = at;
  if (at < text_.size() && text_[at] == '"') {
    cell.quoted = true;
    cell.begin = at + 1;
    for (end = at + 1;; end += 2) {
      end = text_.find('"', end);
      if (end == std::string_view::npos)
        return fault(at, "a quoted cell begins here and is not closed");
      if (end + 1 >= text_.size() || text_[end + 1] != '"') break;
    }
    cell.end = end++;
    if (!ends(end)) return fault(end, "text after the end of a quoted cell");
  } else {
    cell.begin = at;
    while (!ends(end)) ++end;
    cell.end = end;
  }
  cell.last = end >= text_.size() || text_[end] != delimiter_;
  cell.next = cell.last ? behind_line_end(text_, end) : end + 1;
  return cell;
}

std::string Table::text_of(const Cell& cell) const {
  const std::string_view raw = text_.substr(cell.begin, cell.end - cell.begin);
  std::string text;
  if (!cell.quoted) {
    text = trimmed(raw);
  } else {
    for (std::size_t i = 0; i < raw.size(); ++i) {
      text += raw[i];
      if (raw[i] == '"') ++i;
    }
  }
  if (text.starts_with('\'') && is_formula(text)) text.erase(0, 1);
  return text;
}

Result<Table> Table::read(std::string_view text, const std::string& path) {
  Table table(without_byte_order_mark(text), path);
  std::size_t at = 0;
  if (Status status = table.read_header(at); !status) return status.error();
  if (Status status = table.read_rows(at); !status) return status.error();
  return table;
}

Status Table::read_header(std::size_t& at) {
  // Tables of OpenSim (.mot, .sto) begin after this line.
  const std::size_t end = text_.substr(0, std::size_t{64} << 10).find("\nendheader");
  if (end != std::string_view::npos) at = std::min(text_.find('\n', end + 1), text_.size());
  while (at < text_.size() && is_space(text_[at])) ++at;
  if (at == text_.size()) return Error("csv-empty", "the table is empty").in_file(path_);
  const std::size_t begin = at;
  // numpy writes headers with a '#'.
  if (text_[at] == '#') {
    ++at;
    while (at < text_.size() && text_[at] == ' ') ++at;
  }
  header_ = at;
  delimiter_ = delimiter_of(text_, at);
  bool all_numbers = true;
  for (bool last = false; !last;) {
    const auto cell = cell_at(at);
    if (!cell) return cell.error();
    const std::string name = text_of(*cell);
    all_numbers = all_numbers && parse_finite(name).has_value();
    columns_.push_back(parse_column_name(name));
    at = cell->next;
    last = cell->last;
  }
  if (!all_numbers) return {};
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    columns_[c] = {std::to_string(c + 1), fmt::format("column {}", c + 1), {}};
  }
  at = begin;
  return {};
}

Status Table::read_rows(std::size_t at) {
  numeric_.assign(columns_.size(), 1);
  std::vector<std::uint8_t> any(columns_.size(), 0);
  while (at < text_.size()) {
    if (is_line_end(text_[at])) {
      ++at;
      continue;
    }
    const std::size_t begin = at;
    rows_.push_back(at);
    std::size_t count = 0;
    for (bool last = false; !last; ++count) {
      const auto cell = cell_at(at);
      if (!cell) return cell.error();
      if (count < columns_.size() && numeric_[count] != 0) {
        const auto value =
            parse_cell(text_.substr(cell->begin, cell->end - cell->begin), delimiter_);
        if (!value) numeric_[count] = 0;
        if (value && *value == *value) any[count] = 1;
      }
      at = cell->next;
      last = cell->last;
    }
    if (count == columns_.size()) continue;
    Error error("csv-ragged", fmt::format("{} here, {} in the header", counted(count, "cell"),
                                          counted(columns_.size(), "column")));
    error.where = place_of(begin);
    return error;
  }
  if (rows_.empty()) {
    return Error("csv-empty", "the table has a header and no rows").in_file(path_);
  }
  for (std::size_t c = 0; c < any.size(); ++c) numeric_[c] &= any[c];
  return {};
}

Result<std::size_t> Table::find(std::string_view name) const {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].header == name) return c;
  }
  std::optional<std::size_t> found;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].label != name) continue;
    if (found) {
      return Error("csv-column", fmt::format("several columns are named '{}'", shown(name)),
                   fmt::format("write '{}' or '{}'", shown(columns_[*found].header),
                               shown(columns_[c].header)))
          .in_file(path_);
    }
    found = c;
  }
  if (found) return *found;
  constexpr std::size_t kMaxNames = 12;
  std::string names;
  for (std::size_t c = 0; c < std::min(columns_.size(), kMaxNames); ++c) {
    names += (c > 0 ? ", " : "") + shown(columns_[c].header);
  }
  if (columns_.size() > kMaxNames)
    names += fmt::format(" and {} more", columns_.size() - kMaxNames);
  std::vector<std::string> headers;
  for (const auto& column : columns_) headers.push_back(column.header);
  const std::string near = nearest_name(name, headers);
  return Error("csv-column", fmt::format("no column is named '{}'", shown(name)),
               2 * std::ranges::count(headers, "") > std::ssize(headers)
                   ? "names of columns are read from the first line: leave out the lines above them"
                   : (near.empty() ? "" : fmt::format("did you mean '{}'? ", shown(near))) +
                         "columns are " + names)
      .in_file(path_);
}

Result<std::vector<std::vector<double>>> Table::numbers(
    std::span<const std::size_t> columns) const {
  std::vector<std::vector<std::size_t>> wanted_by(columns_.size());
  std::size_t end = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    wanted_by[columns[i]].push_back(i);
    end = std::max(end, columns[i] + 1);
  }
  std::vector<std::vector<double>> values(columns.size());
  for (auto& column : values) column.reserve(rows_.size());
  for (std::size_t at : rows_) {
    for (std::size_t c = 0; c < end; ++c) {
      const auto cell = cell_at(at);
      if (!cell) return cell.error();
      at = cell->next;
      if (wanted_by[c].empty()) continue;
      const std::string_view text = text_.substr(cell->begin, cell->end - cell->begin);
      const auto value = parse_cell(text, delimiter_);
      if (!value) {
        Error error("csv-number",
                    fmt::format("'{}' in the column '{}' is not a number", shown(trimmed(text)),
                                shown(columns_[c].header)),
                    text.find(',') != std::string_view::npos ? "use a decimal point" : "");
        error.where = place_of(cell->begin);
        return error;
      }
      for (const std::size_t i : wanted_by[c]) values[i].push_back(*value);
    }
  }
  return values;
}

Location Table::place_in(std::size_t row_begin, std::size_t column) const {
  for (std::size_t c = 0; c < column; ++c) {
    const auto cell = cell_at(row_begin);
    if (!cell) break;  // not reached: read() checked every cell
    row_begin = cell->next;
  }
  return place_of(row_begin);
}

Location Table::place(std::size_t row, std::size_t column) const {
  return place_in(rows_[row], column);
}

Location Table::header_location(std::size_t column) const {
  return place_in(header_, column);
}

std::vector<std::string> Table::texts(std::size_t column) const {
  std::vector<std::string> result;
  result.reserve(rows_.size());
  for (std::size_t at : rows_) {
    for (std::size_t c = 0; c <= column; ++c) {
      const auto cell = cell_at(at);
      if (!cell) return result;  // not reached: read() checked every cell
      at = cell->next;
      if (c == column) result.push_back(text_of(*cell));
    }
  }
  return result;
}

}  // namespace krok::csv
