#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/numbers.h"
#include "core/result.h"
#include "draw/plot.h"
#include "math/quaternion.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"
#include "tools/krok-plot/sheet.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::plot {

enum class ChartKind : unsigned char { path, feet, angles, cycles, positions, difference };

struct MotionOptions {
  std::vector<std::vector<ChartKind>> shown;  // of each --show
  bool difference = false;
  std::vector<std::string> joints;  // patterns
  std::optional<EulerOrder> euler;
  std::optional<ClipTime> from, to;
  std::string keys = "auto";  // "auto", "none" or a file
  std::string map;
  GroundChoice ground;  // empty: level at 0
  std::string prints;   // a file of footprints, or empty

  // In order, each once; empty for the default charts.
  std::vector<ChartKind> charts() const;
};

struct TableOptions {
  std::string x;
  std::vector<std::string> y;  // one panel each: a column, or several separated by commas
  std::string by;
  std::vector<std::pair<std::string, std::string>> where;  // column, value
  draw::SeriesStyle style = draw::SeriesStyle::line;
  bool log_x = false;
};

struct Options {
  std::vector<std::string> inputs;
  MotionOptions motion;
  bool table = false;  // whatever the names of the inputs are
  TableOptions columns_of_table;
  bool log_y = false;
  std::string title;
  std::optional<int> columns;
  std::optional<std::array<double, 2>> panel;  // pixels
  SheetOptions sheet;                          // without times, ground and prints of `motion`

  // Whether an option, "--x", was given; set by declare().
  std::function<bool(const char* option)> given;

  bool plots_tables() const;
};

inline draw::Scale scale_of(bool logarithmic) {
  return logarithmic ? draw::Scale::logarithmic : draw::Scale::linear;
}

// What depends on whether the inputs are motions or tables. Code usage.
Status check_inputs(const Options& options);

// The tool. Each call has options of its own.
ToolSpec make_spec();

// Reads motions or tables and writes one chart of them.
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::cli::plot
