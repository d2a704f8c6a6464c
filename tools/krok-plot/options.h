#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/quantity.h"
#include "core/result.h"
#include "draw/plot.h"
#include "math/euler.h"
#include "tools/cli/command_options.h"
#include "tools/cli/tool.h"
#include "tools/krok-plot/sheet.h"

namespace krok::cli::plot {

enum class ChartKind : unsigned char { path, feet, angles, positions, difference };

// The options as given on the command line.
struct Arguments {
  std::vector<std::string> inputs;
  // motions
  std::vector<std::string> show;
  std::vector<std::string> joints;
  std::string euler;
  std::string from, to;
  bool difference = false;
  std::string keys = "auto";
  std::string map;
  std::string prints;
  // tables
  bool table = false;
  std::string x;
  std::vector<std::string> y;
  std::string by;
  std::vector<std::string> where;
  draw::SeriesStyle style = draw::SeriesStyle::line;
  bool log_x = false;
  // chart
  bool log_y = false;
  std::string title;
  std::optional<int> columns;
  std::string panel;
  // images
  SheetOptions sheet;
};

// Options for motions.
struct MotionOptions {
  std::vector<ChartKind> charts;    // in order, each once; empty for the default charts
  std::vector<std::string> joints;  // patterns
  std::optional<EulerOrder> euler;
  std::optional<ClipTime> from, to;
  std::string keys;  // "auto", "none" or a file
  std::string map;
  std::string ground;  // what io::open_terrain() takes; empty: level at 0
  std::string prints;  // a file of footprints, or empty
};

// Options for tables.
struct TableOptions {
  std::string x;
  std::vector<std::string> y;  // one panel each: a column, or several separated by commas
  std::string by;
  std::vector<std::pair<std::string, std::string>> where;  // column, value
  draw::SeriesStyle style = draw::SeriesStyle::line;
  draw::Scale x_scale = draw::Scale::linear, y_scale = draw::Scale::linear;
};

struct Options {
  std::vector<std::string> inputs;
  bool table = false;
  MotionOptions motion;
  TableOptions columns_of_table;
  draw::Scale magnitude_scale = draw::Scale::linear;  // of speeds and distances
  std::string title;
  std::optional<int> columns;
  std::optional<std::pair<double, double>> panel;  // pixels
  SheetOptions sheet;
};

void declare(CommandOptions& command, Arguments& arguments);

// Checks the options alone, independently of the inputs.
Status check(const Arguments& arguments);

// Errors name the option. Code usage for options that cannot be combined.
Result<Options> understand(const Arguments& arguments);

// The tool. Each call has options of its own.
ToolSpec make_spec();

}  // namespace krok::cli::plot
