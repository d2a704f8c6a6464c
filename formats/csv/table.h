#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// Reads numeric CSV tables, such as those written by krok-export, for plots.

namespace krok::csv {

// A column name with its unit: "time [s]", "time (s)" and "time_s" are time in seconds, "knee_deg"
// is knee in degrees. After an underscore only common units of motion data are recognised.
struct ColumnName {
  std::string header;  // as in the file
  std::string label;   // without the unit
  std::string unit;    // empty if there is none
};
ColumnName parse_column_name(std::string_view header);

// A table in a text, which must outlive it. Cells are separated by commas, semicolons or tabs,
// whichever is most frequent in the header, and may be quoted (RFC 4180). The first row has the
// column names, unless all of its cells are numbers: then columns are named "1", "2" and so on.
// Empty rows are skipped. Memory: the names and 8 bytes per row; columns are parsed on demand.
class Table {
 public:
  // `path` is for messages. Codes, with line and column: csv-empty (no rows, or only a header),
  // csv-quote (an unterminated quote, or text after the closing quote), csv-ragged (a row with a
  // different number of cells than the header).
  static Result<Table> read(std::string_view text, const std::string& path);

  const std::vector<ColumnName>& columns() const { return columns_; }
  std::size_t row_count() const { return rows_.size(); }

  // 1 for columns that have only numbers and gaps, and at least one number.
  const std::vector<std::uint8_t>& numeric() const { return numeric_; }

  // The column whose header, or else whose label, is `name`; csv-column if none or several match.
  Result<std::size_t> find(std::string_view name) const;

  // The numbers of columns, shape [columns][rows]. Empty cells, NaN, NA, null and infinities are
  // gaps, returned as NaN. csv-number, with line and column, for any other cell.
  Result<std::vector<std::vector<double>>> numbers(std::span<const std::size_t> columns) const;

  // Location of a cell, and of a column name; for messages. Takes time linear in the offset.
  Location place(std::size_t row, std::size_t column) const;
  Location header_location(std::size_t column) const;

  // The cells of a column as text, without quotes. [rows]
  std::vector<std::string> texts(std::size_t column) const;

 private:
  Table(std::string_view text, std::string path) : text_(text), path_(std::move(path)) {}

  struct Cell {
    std::size_t begin = 0, end = 0;  // inside the quotes, if any
    bool quoted = false;
    std::size_t next = 0;  // after the delimiter or line end
    bool last = false;     // of its row
  };
  Result<Cell> cell_at(std::size_t at) const;
  std::string text_of(const Cell& cell) const;
  Status read_header(std::size_t& at);
  Status read_rows(std::size_t at);
  Location place_of(std::size_t offset) const;
  Location place_in(std::size_t row_begin, std::size_t column) const;

  std::string_view text_;
  std::string path_;
  char delimiter_ = ',';
  std::vector<ColumnName> columns_;
  std::size_t header_ = 0;         // offset; that of the first row if there is no header
  std::vector<std::size_t> rows_;  // offsets
  std::vector<std::uint8_t> numeric_;
};

}  // namespace krok::csv
