#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

// Numeric tables as text: what krok-export and scripts write, for plots.

namespace krok::csv {

// A column's name, with the unit that stands in it: "time [s]", "time (s)" and "time_s" are time in
// seconds, "knee_deg" is knee in degrees. Of the form with an underscore only common units of
// motion are understood.
struct ColumnName {
  std::string header;  // as it stands in the file
  std::string label;   // without the unit
  std::string unit;    // empty where none stands there
};
ColumnName parse_column_name(std::string_view header);

// A table in a text that outlives it. Cells are told apart by commas, semicolons or tabs, whichever
// the header has most of; quoted as RFC 4180 has it. The first row names the columns, unless all of
// its cells are numbers: then columns are called "1", "2" and so on. Empty rows are passed over.
// Takes memory for the names and 8 bytes a row; columns are read when they are asked for.
class Table {
 public:
  // `path` is for messages. Codes, with line and column: csv-empty (no row, or a header and no
  // row), csv-quote (a quote that does not end, or text after its end), csv-ragged (a row with
  // another number of cells than the header).
  static Result<Table> read(std::string_view text, const std::string& path);

  const std::vector<ColumnName>& columns() const { return columns_; }
  std::size_t row_count() const { return rows_.size(); }

  // 1 for columns that hold numbers and gaps and nothing else, and at least one number.
  const std::vector<std::uint8_t>& numeric() const { return numeric_; }

  // The column whose header, or else whose label, is `name`; csv-column where none or several are.
  Result<std::size_t> find(std::string_view name) const;

  // The numbers of columns, shape [columns][rows]. Cells that are empty, NaN, NA or null, and
  // infinities, are gaps: NaN. csv-number, with line and column, for a cell that is something else.
  Result<std::vector<std::vector<double>>> numbers(std::span<const std::size_t> columns) const;

  // Where a cell begins, and a column's name; for messages. Takes time with the text before it.
  Location place(std::size_t row, std::size_t column) const;
  Location header_location(std::size_t column) const;

  // A column's cells as they stand, quotes taken off. [rows]
  std::vector<std::string> texts(std::size_t column) const;

 private:
  Table(std::string_view text, std::string path) : text_(text), path_(std::move(path)) {}

  struct Cell {
    std::size_t begin = 0, end = 0;  // within the quotes, if there are any
    bool quoted = false;
    std::size_t next = 0;  // behind the delimiter or the line's end
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
  std::size_t header_ = 0;         // where it begins; the first row's place where there is none
  std::vector<std::size_t> rows_;  // where each begins
  std::vector<std::uint8_t> numeric_;
};

}  // namespace krok::csv
