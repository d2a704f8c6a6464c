#include "tools/krok-plot/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/table.h"
#include "tools/cli/paths.h"

namespace krok::cli::plot {

namespace {

using csv::ColumnName;
using csv::Table;

constexpr std::size_t kMaxLines = 60;  // per panel: more cannot be distinguished
constexpr std::size_t kMaxNames = 30;  // in a hint

// The columns of a table to draw.
struct Choice {
  std::optional<std::size_t> x;                  // empty for the row number
  std::vector<std::vector<std::size_t>> panels;  // columns
  std::vector<std::size_t> by;
};

// Whether a column is a frame or time counter rather than data.
bool is_counter(const ColumnName& name) {
  return same_word(name.label, "frame") || same_word(name.label, "time") ||
         same_word(name.label, "t");
}

// A column's label and unit, including the unit that krok-export's tables leave out.
ColumnName understood(const Table& table, std::size_t column) {
  ColumnName name = table.columns()[column];
  const auto& columns = table.columns();
  const bool from_export =
      columns.size() > 2 && columns[0].header == "frame" && columns[1].header == "time";
  if (!from_export || !name.unit.empty()) return name;
  if (column == 1) name.unit = "s";
  if (columns.size() == 6 && columns[2].header == "joint" && column > 2) name.unit = "m";
  return name;
}

std::optional<std::size_t> usual_x(const Table& table) {
  const auto& columns = table.columns();
  for (const char* wanted : {"time", "t", "frame"}) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (table.numeric()[c] != 0 && same_word(columns[c].label, wanted)) return c;
    }
  }
  if (table.numeric()[0] != 0 && columns.size() > 1) return 0;
  return std::nullopt;
}

// All numeric columns except x, one panel per unit.
std::vector<std::vector<std::size_t>> usual_panels(const Table& table,
                                                   std::optional<std::size_t> x) {
  std::vector<std::string> units;
  std::vector<std::vector<std::size_t>> panels;
  for (std::size_t c = 0; c < table.columns().size(); ++c) {
    if (table.numeric()[c] == 0 || c == x || is_counter(table.columns()[c])) continue;
    const std::string unit = understood(table, c).unit;
    const auto found = std::find(units.begin(), units.end(), unit);
    const auto place = static_cast<std::size_t>(found - units.begin());
    if (found == units.end()) {
      units.push_back(unit);
      panels.emplace_back();
    }
    panels[place].push_back(c);
  }
  return panels;
}

// One column whose name is the whole text, or else comma-separated names.
Result<std::vector<std::size_t>> find_columns(const Table& table, const std::string& names) {
  if (const auto whole = table.find(names)) return std::vector<std::size_t>{*whole};
  std::vector<std::size_t> columns;
  for (std::size_t begin = 0; begin <= names.size();) {
    const std::size_t end = std::min(names.find(',', begin), names.size());
    const auto column = table.find(trimmed(std::string_view(names).substr(begin, end - begin)));
    if (!column) {
      Error error = column.error();
      if (table.find("joint")) error.hint += "; --where joint=NAME takes the rows of one joint";
      return error;
    }
    columns.push_back(*column);
    begin = end + 1;
  }
  return columns;
}

// A column that no option names, of numbers but for a cell that is none, would be taken for words.
Status check_numbers(const Table& table, const TableOptions& options) {
  for (std::size_t c = 0; c < table.columns().size(); ++c) {
    const ColumnName& name = table.columns()[c];
    const auto is_named = [&](const std::string& option) {
      return option == name.header || option == name.label;
    };
    if (table.numeric()[c] != 0 || is_named(options.by) ||
        std::ranges::any_of(options.where, [&](const auto& one) { return is_named(one.first); })) {
      continue;
    }
    const auto cells = table.texts(c);
    const auto count = std::ranges::count_if(
        cells, [](const std::string& cell) { return parse_finite(cell).has_value(); });
    if (2 * count < static_cast<std::ptrdiff_t>(cells.size()) || count == 0) continue;
    Error error = table.numbers(std::array{c}).error();
    error.hint = fmt::format("mend the cell or leave it empty; --by {} takes the column for words",
                             shown(name.header));
    return error;
  }
  return {};
}

Result<Choice> choose(const Table& table, const TableOptions& options) {
  Choice choice;
  if (options.x.empty()) {
    choice.x = usual_x(table);
  } else {
    const auto x = table.find(options.x);
    if (!x) return x.error();
    choice.x = *x;
  }
  for (const std::string& names : options.y) {
    auto columns = find_columns(table, names);
    if (!columns) return columns.error();
    choice.panels.push_back(std::move(*columns));
  }
  if (options.by.empty() || options.y.empty()) {
    if (Status status = check_numbers(table, options); !status) return status.error();
  }
  if (options.y.empty()) choice.panels = usual_panels(table, choice.x);
  if (!options.by.empty()) {
    const auto by = table.find(options.by);
    if (!by) return by.error();
    choice.by = {*by};
    return choice;
  }
  const bool alone = std::ranges::count(table.numeric(), 0) == 1;
  for (std::size_t c = 0; c < table.columns().size(); ++c) {
    if (table.numeric()[c] != 0) continue;
    const auto cells = table.texts(c);
    // Words that differ from row to row name no lines.
    const std::set<std::string> values(cells.begin(), cells.end());
    if (alone || 2 * values.size() <= cells.size()) choice.by.push_back(c);
  }
  return choice;
}

// The rows that satisfy all conditions.
Result<std::vector<std::size_t>> chosen_rows(const Table& table, const TableOptions& options) {
  std::map<std::size_t, std::set<std::string>> wanted;
  for (const auto& [name, value] : options.where) {
    const auto column = table.find(name);
    if (!column) return column.error();
    wanted[*column].insert(value);
  }
  std::vector<std::uint8_t> chosen(table.row_count(), 1);
  for (const auto& [column, values] : wanted) {
    const auto cells = table.texts(column);
    for (std::size_t row = 0; row < cells.size(); ++row) {
      if (values.count(cells[row]) == 0) chosen[row] = 0;
    }
  }
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < chosen.size(); ++row) {
    if (chosen[row] != 0) rows.push_back(row);
  }
  if (!rows.empty()) return rows;
  Error error("plot-where", "no row of the table matches --where");
  for (const auto& [column, values] : wanted) {
    const auto cells = table.texts(column);
    const std::set<std::string> known(cells.begin(), cells.end());
    const std::vector<std::string> names(known.begin(), known.end());
    for (const std::string& value : values) {
      if (known.contains(value)) continue;
      error.message +=
          fmt::format(": no {} is '{}'", shown(table.columns()[column].header), shown(value));
      if (names.size() <= kMaxNames) error.hint = nearest_hint(value, names);
      return error;
    }
  }
  return error;
}

// The rows of one line: those with the same values in the columns `by`, in order of appearance.
// Columns of one value are not in the name.
struct Group {
  std::string name;
  std::vector<std::size_t> rows;
};

Result<std::vector<Group>> group(const Table& table, const std::vector<std::size_t>& rows,
                                 const std::vector<std::size_t>& by) {
  std::vector<std::string> names(rows.size());
  std::string columns;
  for (const std::size_t column : by) {
    const auto cells = table.texts(column);
    const auto value = [&](std::size_t row) -> const std::string& { return cells[row]; };
    const bool same = std::ranges::all_of(
        rows, [&](std::size_t row) { return value(row) == value(rows.front()); });
    if (same && by.size() > 1) continue;
    columns += (columns.empty() ? "" : ", ") + shown(table.columns()[column].header);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      names[i] += (names[i].empty() ? "" : " ") + value(rows[i]);
    }
  }
  std::vector<Group> groups;
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto [found, is_new] = places.emplace(names[i], groups.size());
    if (is_new) groups.push_back({names[i], {}});
    groups[found->second].rows.push_back(rows[i]);
    if (groups.size() > kMaxLines) {
      return Error("plot-lines",
                   fmt::format("'{}' has more than {} values, each of which would be a line",
                               columns, kMaxLines),
                   "--where COLUMN=VALUE selects rows; --by selects another column");
    }
  }
  return groups;
}

// The label of a panel's y axis: the column name if there is one column, and the common unit.
draw::Axis y_axis(const Table& table, const std::vector<std::size_t>& columns) {
  draw::Axis axis;
  const ColumnName first = understood(table, columns.front());
  axis.unit = first.unit;
  for (const std::size_t column : columns) {
    if (understood(table, column).unit != axis.unit) axis.unit.clear();
  }
  if (columns.size() == 1) axis.label = first.label;
  return axis;
}

draw::Axis x_axis(const Table& table, std::optional<std::size_t> x) {
  if (!x) return {"row"};
  const ColumnName name = understood(table, *x);
  return {name.label, name.unit};
}

// Adds the lines of one file to the panels.
class TableLines {
 public:
  TableLines(const Table& table, const Choice& choice, const TableOptions& options)
      : table_(table), choice_(choice), options_(options) {}

  // `file` is prepended to the names of lines unless it is empty.
  Status add_to(std::vector<draw::Panel>& panels, const std::string& file) {
    const auto rows = chosen_rows(table_, options_);
    if (!rows) return rows.error();
    const auto groups = group(table_, *rows, choice_.by);
    if (!groups) return groups.error();
    std::vector<std::size_t> columns;
    if (choice_.x) columns.push_back(*choice_.x);
    for (const auto& panel : choice_.panels) {
      if (panel.size() * groups->size() > kMaxLines) return too_many(panel.size(), groups->size());
      columns.insert(columns.end(), panel.begin(), panel.end());
    }
    const auto numbers = table_.numbers(columns);
    if (!numbers) return numbers.error();
    std::size_t next = choice_.x ? 1 : 0;
    for (std::size_t p = 0; p < choice_.panels.size(); ++p) {
      for (const std::size_t column : choice_.panels[p]) {
        const std::vector<double>& values = (*numbers)[next++];
        for (const Group& lines : *groups) {
          draw::Series series = line(numbers->front(), values, lines.rows);
          series.name = name_of(file, column, lines.name, choice_.panels[p].size() > 1);
          panels[p].series.push_back(std::move(series));
        }
      }
    }
    return {};
  }

 private:
  draw::Series line(const std::vector<double>& x, const std::vector<double>& values,
                    const std::vector<std::size_t>& rows) const {
    draw::Series series;
    series.style = options_.style;
    for (const std::size_t row : rows) {
      series.x.push_back(choice_.x ? x[row] : static_cast<double>(row + 1));
      series.y.push_back(values[row]);
    }
    return series;
  }

  std::string name_of(const std::string& file, std::size_t column, const std::string& group_name,
                      bool several) const {
    std::string name = group_name;
    if (several || (name.empty() && file.empty()))
      name += (name.empty() ? "" : " ") + understood(table_, column).label;
    if (!file.empty()) name += (name.empty() ? "" : ", ") + file;
    return name;
  }

  static Error too_many(std::size_t columns, std::size_t groups) {
    return Error("plot-lines",
                 fmt::format("a panel would have {} lines, the limit is {}",
                             grouped(columns * groups), kMaxLines),
                 "--y selects columns, --where COLUMN=VALUE rows");
  }

  const Table& table_;
  const Choice& choice_;
  const TableOptions& options_;
};

void report_choice(const Table& table, const Choice& choice, const TableOptions& options,
                   const std::string& path, ToolContext& context) {
  std::string chosen;
  const auto add = [&](std::string_view words) {
    chosen += chosen.empty() ? "" : ", ";
    chosen += words;
  };
  if (options.x.empty()) {
    add(choice.x ? fmt::format("x is '{}'", shown(table.columns()[*choice.x].header))
                 : "x is the row number");
  }
  for (const std::size_t column : choice.by) {
    if (options.by.empty()) {
      add(fmt::format("one line per '{}'", shown(table.columns()[column].header)));
    }
  }
  if (options.y.empty()) add("all numeric columns are drawn");
  if (chosen.empty()) return;
  Diagnostic note =
      make_warning("plot-columns", std::move(chosen), "use --x, --y and --by to change this");
  note.severity = Severity::note;
  context.diagnose_in(path, {note});
}

Status add_table(const std::string& path, const Options& options, ToolContext& context,
                 draw::Chart& chart) {
  const auto input = context.open_input(path);
  if (!input) return input.error();
  const auto table = Table::read(input->text(), path);
  if (!table) return table.error();
  const TableOptions& wanted = options.columns_of_table;
  const auto choice = choose(*table, wanted);
  if (!choice) return choice.error();
  if (choice->panels.empty()) {
    return Error("plot-columns", "the table has no numeric column to draw");
  }
  report_choice(*table, *choice, wanted, path, context);
  if (chart.panels.empty()) {
    for (const auto& columns : choice->panels) {
      draw::Panel panel;
      panel.x = x_axis(*table, choice->x);
      panel.y = y_axis(*table, columns);
      panel.x.scale = scale_of(wanted.log_x);
      panel.y.scale = scale_of(options.log_y);
      chart.panels.push_back(std::move(panel));
    }
  }
  if (chart.panels.size() != choice->panels.size()) {
    return Error("plot-columns", "the tables do not have the same columns",
                 "select columns with --x and --y");
  }
  const bool several = options.inputs.size() > 1;
  Status status = TableLines(*table, *choice, wanted)
                      .add_to(chart.panels, several ? name_of_input(path) : std::string());
  // A single line is labelled by its axis.
  for (draw::Panel& panel : chart.panels) panel.legend = panel.series.size() > 1;
  return status;
}

}  // namespace

Result<draw::Chart> chart_tables(const Options& options, ToolContext& context) {
  draw::Chart chart;
  for (const std::string& path : options.inputs) {
    if (Status status = add_table(path, options, context, chart); !status) {
      return std::move(status.error()).in_file(path);
    }
  }
  return chart;
}

}  // namespace krok::cli::plot
